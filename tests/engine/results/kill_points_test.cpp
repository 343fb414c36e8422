// A writer that is stopped before each of its writes: whenever a kill comes, what the file names is whole.

#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>

#include "engine/results/result_file.hpp"
#include "tests/engine/results/h5_read.hpp"
#include "tests/engine/results/known_frames.hpp"

namespace quicksand {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t points = 50;
/// An ordinary frame, and those with which nodes split: of names after every 16 from the 32nd on, of chunks
/// at the 64th.
constexpr std::array<std::size_t, 4> looked_at{1, 32, 48, 64};
constexpr std::size_t frames = looked_at.back() + 1;

bool is_looked_at(std::size_t k) {
  return std::find(looked_at.begin(), looked_at.end(), k) != looked_at.end();
}

/// Stops before and after each frame that is looked at.
[[noreturn]] void write_frames(const fs::path& folder) {
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
  raise(SIGSTOP);
  ResultFile file(folder.string(), {});
  file.begin(known::series());
  for (std::size_t k = 0; k < frames; ++k) {
    file.sample(known::time(k), known::sample(k));
    if (is_looked_at(k)) raise(SIGSTOP);
    file.frame(known::frame(k, points));
    if (is_looked_at(k)) raise(SIGSTOP);
  }
  _exit(0);
}

/// Lets the writer go on to where it stops by itself; false when it has ended.
bool to_own_stop(pid_t writer) {
  int status = 0;
  return ptrace(PTRACE_CONT, writer, nullptr, nullptr) == 0 && waitpid(writer, &status, 0) == writer &&
         WIFSTOPPED(status);
}

/// Lets the writer go on to the entry of its next write to a file; false when it stops by itself or has
/// ended.
bool to_next_write(pid_t writer) {
  constexpr int at_call = SIGTRAP | 0x80;
  for (int status = 0;;) {
    if (ptrace(PTRACE_SYSCALL, writer, nullptr, nullptr) != 0 || waitpid(writer, &status, 0) != writer ||
        !WIFSTOPPED(status) || WSTOPSIG(status) != at_call)
      return false;
    __ptrace_syscall_info call{};
    if (ptrace(PTRACE_GET_SYSCALL_INFO, writer, sizeof call, &call) <= 0) return false;
    if (call.op == PTRACE_SYSCALL_INFO_ENTRY &&
        (call.entry.nr == SYS_pwrite64 || call.entry.nr == SYS_ftruncate))
      return true;
  }
}

std::string name_of(std::size_t k) {
  char name[32];
  std::snprintf(name, sizeof name, "/frames/%06zu", k);
  return name;
}

void expect_whole(const h5_read::File& file, std::size_t k) {
  const Frame frame = known::frame(k, points);
  EXPECT_EQ(file.attribute(name_of(k), "time"), frame.time);
  EXPECT_EQ(file.doubles(name_of(k) + "/position"), frame.position) << k;
  const auto field = file.doubles(name_of(k) + "/displacement");
  EXPECT_TRUE(std::equal(field.begin(), field.end(), frame.fields[0].values.begin())) << k;
}

/// While frame `now` is written: those before it are counted, named and whole, and it is whole if it is
/// named.
void expect_whole_until(const fs::path& path, std::size_t now) {
  const h5_read::File file(path.string());
  const auto counted = static_cast<std::size_t>(file.attribute("/VTKHDF/Steps", "NSteps"));
  ASSERT_TRUE(counted == now || counted == now + 1) << counted;
  EXPECT_GE(file.doubles("/VTKHDF/Steps/Values").size(), counted);
  EXPECT_GE(file.doubles("/series/probe.below/value").size(), counted);
  for (const std::size_t k : {std::size_t{0}, now / 2, now - 1}) expect_whole(file, k);
  if (counted == now + 1 || file.has("/frames", name_of(now).substr(8))) expect_whole(file, now);
}

TEST(KillPoints, WhatIsNamedIsWholeBeforeEveryWrite) {
  std::string pattern = (fs::temp_directory_path() / "quicksand-kills-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const fs::path folder = pattern;
  const pid_t writer = fork();
  if (writer == 0) write_frames(folder);
  int status = 0;
  waitpid(writer, &status, 0);
  if (WIFSTOPPED(status)) {
    ptrace(PTRACE_SETOPTIONS, writer, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
    for (const std::size_t now : looked_at) {
      ASSERT_TRUE(to_own_stop(writer));
      std::size_t writes = 0;
      for (; to_next_write(writer) && !HasFailure(); ++writes) {
        SCOPED_TRACE("frame " + std::to_string(now) + ", write " + std::to_string(writes));
        EXPECT_NO_THROW(expect_whole_until(folder / "result.vtkhdf.part", now));
      }
      EXPECT_GT(writes, 20U);
    }
    kill(writer, SIGKILL);
    waitpid(writer, nullptr, 0);
  }
  fs::remove_all(folder);
  if (!WIFSTOPPED(status)) GTEST_SKIP() << "no process may be traced here";
}

}  // namespace
}  // namespace quicksand

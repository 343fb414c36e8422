// A writer that is stopped before each of its writes: whenever a kill comes, what the file names is whole.

#include <gtest/gtest.h>
#include <sys/mman.h>
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

[[noreturn]] void write_frames(const fs::path& folder, volatile std::size_t& now) {
  if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
  raise(SIGSTOP);
  ResultFile file(folder.string(), {});
  file.begin(known::series());
  for (std::size_t k = 0; k < frames; ++k) {
    now = k;
    file.sample(known::time(k), known::sample(k));
    file.frame(known::frame(k, points));
  }
  _exit(0);
}

/// Runs the writer to the entry of its next write to a file; false when it has ended.
bool to_next_write(pid_t writer) {
  for (int status = 0;;) {
    if (ptrace(PTRACE_SYSCALL, writer, nullptr, nullptr) != 0 || waitpid(writer, &status, 0) != writer ||
        WIFEXITED(status) || WIFSIGNALED(status))
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
  void* shared =
      mmap(nullptr, sizeof(std::size_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  volatile auto& now = *static_cast<volatile std::size_t*>(shared);
  const pid_t writer = fork();
  if (writer == 0) write_frames(folder, now);
  int status = 0;
  waitpid(writer, &status, 0);
  if (WIFSTOPPED(status)) {
    ptrace(PTRACE_SETOPTIONS, writer, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
    std::size_t stops = 0;
    while (to_next_write(writer) && !HasFailure()) {
      if (std::find(looked_at.begin(), looked_at.end(), now) == looked_at.end()) continue;
      ++stops;
      SCOPED_TRACE("frame " + std::to_string(now) + ", stop " + std::to_string(stops));
      EXPECT_NO_THROW(expect_whole_until(folder / "result.vtkhdf.part", now));
    }
    kill(writer, SIGKILL);
    EXPECT_GT(stops, 20 * looked_at.size());
    EXPECT_EQ(now, frames - 1);
  }
  munmap(shared, sizeof(std::size_t));
  fs::remove_all(folder);
  if (!WIFSTOPPED(status)) GTEST_SKIP() << "no process may be traced here";
}

}  // namespace
}  // namespace quicksand

#include "server/execute.hpp"

#include <gtest/gtest.h>

#include "engine/results/checkpoint_file.hpp"
#include "engine/run/engine_build.hpp"
#include "server/files.hpp"
#include "server/run_json.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

class CountingMonitor final : public RunMonitor {
 public:
  explicit CountingMonitor(long cancel_after = -1) : cancel_after_(cancel_after) {}
  void progress(const Progress&) override { ++steps; }
  bool cancelled() override { return cancel_after_ >= 0 && steps >= cancel_after_; }
  long steps = 0;

 private:
  long cancel_after_;
};

std::string small_case() { return read_text(SMALL_CASE).value(); }

TEST(Execute, LeavesItsThreeFiles) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "new" / "out";
  CountingMonitor monitor;
  const Execution done = execute(small_case(), {}, out.string(), monitor, {});
  EXPECT_TRUE(done.faults.empty());
  EXPECT_EQ(done.report.status, RunStatus::succeeded) << done.report.failure.message;
  EXPECT_GT(monitor.steps, 0);
  for (const char* name : {"result.vtkhdf", "result.xdmf", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(out / name)) << name;
  for (const auto& entry : std::filesystem::directory_iterator(out))
    EXPECT_NE(entry.path().extension(), ".part");
  EXPECT_TRUE(Json::accept(read_text(out / "run.json").value()));
}

TEST(Execute, WritesNothingForABadCase) {
  const TemporaryFolder folder;
  CountingMonitor monitor;
  const auto out = folder.path() / "out";
  const Execution done = execute("{]", {}, out.string(), monitor, {});
  EXPECT_FALSE(done.faults.empty());
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Execute, SaysWhenItCannotWrite) {
  const TemporaryFolder folder;
  write_atomically(folder.path() / "file", "");
  CountingMonitor monitor;
  const Execution done = execute(small_case(), {}, (folder.path() / "file").string(), monitor, {});
  EXPECT_EQ(done.report.status, RunStatus::failed);
  EXPECT_EQ(done.report.failure.code, "output");
  EXPECT_EQ(monitor.steps, 0);
}

TEST(Execute, CancelsWithinOneStep) {
  const TemporaryFolder folder;
  CountingMonitor monitor(3);
  const Execution done = execute(small_case(), {}, folder.path().string(), monitor, {});
  EXPECT_EQ(done.report.status, RunStatus::canceled);
  EXPECT_LE(monitor.steps, 4);
}

/// Suspends a run after some steps; keeps what is said.
class SuspendingMonitor final : public RunMonitor {
 public:
  explicit SuspendingMonitor(long after) : after_(after) {}
  void progress(const Progress&) override { ++steps_; }
  void log(const std::string& line) override { words += line + "\n"; }
  bool suspended() override { return after_ >= 0 && steps_ >= after_; }
  std::string words;

 private:
  long after_, steps_ = 0;
};

TEST(Execute, ACheckpointOfAnotherBuildIsOfNoUse) {
  const TemporaryFolder folder;
  SuspendingMonitor first(200);
  EXPECT_EQ(execute(small_case(), {}, folder.path().string(), first, {}).report.status, RunStatus::suspended);
  const auto file = folder.path() / "checkpoint";
  StoredCheckpoint stored = read_checkpoint(file);
  ASSERT_NE(stored.identity.find(engine_build()), std::string::npos);
  stored.identity.replace(stored.identity.find(engine_build()), 1, "x");
  remove_checkpoints(folder.path());
  store_checkpoint(folder.path(), stored.identity, stored.results, stored.run);
  SuspendingMonitor required(-1);
  const Execution refused = execute(small_case(), {}, folder.path().string(), required, {}, Resume::required);
  EXPECT_EQ(refused.report.failure.code, "no_checkpoint");
  SuspendingMonitor second(-1);
  const Execution done = execute(small_case(), {}, folder.path().string(), second, {}, Resume::if_possible);
  EXPECT_EQ(done.report.status, RunStatus::succeeded);
  EXPECT_NE(second.words.find("another case or build"), std::string::npos) << second.words;
  EXPECT_EQ(second.words.find("resumed at"), std::string::npos) << second.words;
}

}  // namespace
}  // namespace quicksand

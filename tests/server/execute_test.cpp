#include "server/execute.hpp"

#include <gtest/gtest.h>

#include "server/files.hpp"
#include "server/run_json.hpp"
#include "tests/server/temporary_folder.hpp"

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

}  // namespace
}  // namespace quicksand

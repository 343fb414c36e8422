#include "server/limits.hpp"

#include <gtest/gtest.h>

#include "server/files.hpp"
#include "server/machine.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

constexpr double GB = 1e9;

TEST(Limits, ACaseIsHeldToPointsAndMemory) {
  Settings settings;
  settings.max_points = 1000;
  settings.max_memory = 2'000'000'000;
  EXPECT_TRUE(too_large(settings, {1000, 2 * GB, 1}).empty());
  const auto faults = too_large(settings, {1001, 2.1 * GB, 1});
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].pointer, "/domain/cell_size");
  EXPECT_NE(faults[0].detail.find("1001 points; at most 1000 (max_points)"), std::string::npos)
      << faults[0].detail;
  EXPECT_NE(faults[1].detail.find("2.1 GB"), std::string::npos) << faults[1].detail;
  EXPECT_NE(faults[1].detail.find("max_memory"), std::string::npos);
}

TEST(Limits, MemoryIsTheMachinesShareUnlessSet) {
  EXPECT_DOUBLE_EQ(memory_limit({}), 0.8 * machine_memory());
  Settings settings;
  settings.max_memory = 5;
  EXPECT_EQ(memory_limit(settings), 5);
}

TEST(Limits, ThreadsFollowTheSize) {
  Settings settings;
  settings.points_per_thread = 100;
  EXPECT_EQ(threads_for(settings, {0, 0, 0}), 1);
  EXPECT_EQ(threads_for(settings, {199, 0, 0}), 1);
  EXPECT_EQ(threads_for(settings, {1'000'000'000, 0, 0}), machine_cores());
  settings.threads_per_run = 3;
  EXPECT_EQ(threads_for(settings, {0, 0, 0}), 3);
}

TEST(Limits, DiskHasReserveAndQuota) {
  const TemporaryFolder folder;
  const StateFolder state(folder.path());
  Settings settings;
  settings.disk_reserve = 0;
  EXPECT_EQ(disk_shortage(settings, state, 1e30), "");
  settings.disk_quota = 1000;
  EXPECT_EQ(disk_shortage(settings, state, 1000), "");
  EXPECT_NE(disk_shortage(settings, state, 1001).find("(disk_quota)"), std::string::npos);
  settings.disk_reserve = INT64_MAX;
  EXPECT_NE(disk_shortage(settings, state, 0).find("(disk_reserve)"), std::string::npos);
}

TEST(Limits, AFoldersBytesAreThoseOfItsFiles) {
  const TemporaryFolder folder;
  write_atomically(folder.path() / "a", "12345");
  write_atomically(folder.path() / "b", "123");
  EXPECT_EQ(folder_bytes(folder.path()), 8);
  EXPECT_EQ(folder_bytes(folder.path() / "none"), 0);
}

TEST(Limits, TimeHasABoundOrNot) {
  Settings settings;
  settings.max_run_s = 7200;
  EXPECT_FALSE(out_of_time(settings, 119 * 60.0));
  const auto failure = out_of_time(settings, 121 * 60.0);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code, "time_limit");
  EXPECT_NE(failure->message.find("7200 (max_run_s)"), std::string::npos) << failure->message;
  settings.max_run_s = 0;
  EXPECT_FALSE(out_of_time(settings, 1e9));
}

TEST(Limits, MemoryMayNotGrowBeyondWhatRunsMayTake) {
  Settings settings;
  settings.max_memory = 4'000'000'000;
  EXPECT_FALSE(out_of_memory(settings, 4 * GB));
  const auto failure = out_of_memory(settings, 5 * GB);
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->code, "memory_limit");
}

}  // namespace
}  // namespace quicksand

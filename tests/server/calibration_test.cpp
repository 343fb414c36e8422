// What `quicksand calibrate` keeps, and what it measures of files.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "server/calibrate_output.hpp"
#include "server/calibration_file.hpp"

namespace quicksand {
namespace {

class CalibrationFile : public testing::Test {
 protected:
  CalibrationFile()  // tests may run side by side
      : file_(std::filesystem::path(testing::TempDir()) /
              (std::string("calibration-") + testing::UnitTest::GetInstance()->current_test_info()->name() +
               ".json")) {}
  ~CalibrationFile() override { std::filesystem::remove(file_); }
  void write(const std::string& text) const { std::ofstream(file_) << text; }

  std::filesystem::path file_;
};

TEST_F(CalibrationFile, ComesBackAsItWas) {
  Calibration kept;
  for (std::size_t k = 0; k < kSceneKinds; ++k) kept.cost[k] = {1e-6 * static_cast<double>(k + 1), 1e-7};
  kept.output = {0.1, 2e-6, 3e-3, 4e-6, 7e-4, 8e-8, 5e-3};
  write(calibration_json(kept));
  const Calibration read = read_calibration(file_);
  for (std::size_t k = 0; k < kSceneKinds; ++k) {
    EXPECT_EQ(read.cost[k].step, kept.cost[k].step);
    EXPECT_EQ(read.cost[k].point, kept.cost[k].point);
  }
  EXPECT_EQ(read.output.start, 0.1);
  EXPECT_EQ(read.output.seed_point, 2e-6);
  EXPECT_EQ(read.output.frame, 3e-3);
  EXPECT_EQ(read.output.field, 7e-4);
  EXPECT_EQ(read.output.component, 8e-8);
  EXPECT_EQ(read.output.frame_point, 4e-6);
  EXPECT_EQ(read.output.flush, 5e-3);
}

TEST_F(CalibrationFile, OfAnEarlierVersionSaysNothingOfOutput) {
  Calibration kept;
  kept.cost[0].step = 7e-6;
  kept.output.frame = 1;
  std::string text = calibration_json(kept);
  const std::size_t name = text.find("component_seconds");
  write(text.replace(name, 9, "unheard_of"));  // the version before told frames otherwise
  EXPECT_EQ(read_calibration(file_).cost[0].step, 7e-6);
  EXPECT_EQ(read_calibration(file_).output.frame, OutputCost{}.frame);
  text.erase(text.rfind(",", text.find("\"output\"")));
  write(text + "}");
  const Calibration read = read_calibration(file_);
  EXPECT_EQ(read.cost[0].step, 7e-6);
  EXPECT_EQ(read.output.frame, OutputCost{}.frame);
}

TEST_F(CalibrationFile, MissingOrDamagedIsTheUsualMachine) {
  EXPECT_EQ(read_calibration(file_).cost[0].point, Calibration{}.cost[0].point);
  write("{\"soil\": 1}");
  EXPECT_EQ(read_calibration(file_).cost[0].point, Calibration{}.cost[0].point);
}

TEST(CalibrateOutput, MeasuresFiles) {
  const OutputCost cost = calibrate_output(testing::TempDir(), 0.3);
  EXPECT_GT(cost.start, 1e-3);
  EXPECT_LT(cost.start, 10);
  EXPECT_GT(cost.frame + cost.flush, 1e-5);
  EXPECT_LT(cost.frame + cost.flush, 1);
  EXPECT_GE(cost.field, 0);
  EXPECT_LT(cost.field, 0.1);
  EXPECT_GE(cost.component, 0);
  EXPECT_LT(cost.component, 1e-5);
  EXPECT_GE(cost.frame_point, 0);
  EXPECT_LT(cost.frame_point, 1e-4);
}

TEST(CalibrateOutput, SaysWhereItCannotWrite) {
  EXPECT_THROW(calibrate_output("/nowhere", 0.2), std::runtime_error);
}

}  // namespace
}  // namespace quicksand

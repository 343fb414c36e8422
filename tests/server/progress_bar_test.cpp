#include "server/progress_bar.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace quicksand {
namespace {

TEST(DurationText, ChoosesItsUnit) {
  EXPECT_EQ(duration_text(0.44), "0.4 s");
  EXPECT_EQ(duration_text(59.4), "59 s");
  EXPECT_EQ(duration_text(59.6), "1 min 00 s");
  EXPECT_EQ(duration_text(3725), "1 h 02 min");
  EXPECT_EQ(duration_text(-1), "?");
  EXPECT_EQ(duration_text(NAN), "?");
}

TEST(ProgressText, ShowsStageTimeStepAndWhatIsLeft) {
  Progress progress;
  progress.fraction = 0.5;
  progress.stage = "open valve";
  progress.sim_time = 1.25;
  progress.end_time = 2.5;
  progress.step = 4321;
  progress.time_step = 2e-4;
  progress.eta_s = 75;
  EXPECT_EQ(progress_text(progress),
            "[############............]  50 %  open valve  t 1.25 of 2.5 s  step 4321  dt 2.00e-04 s  left 1 "
            "min 15 s");
}

TEST(ProgressText, NeverLeavesItsBar) {
  Progress progress;
  progress.fraction = 1.3;
  EXPECT_EQ(progress_text(progress).find("[########################] 100 %"), 0u);
}

}  // namespace
}  // namespace quicksand

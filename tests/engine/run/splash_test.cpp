// Water that breaks up into drops: no scheme may give it energy.

#include <gtest/gtest.h>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand {
namespace {

using test::add_body;
using test::plane;

/// A dam break on a hundred cells, against a wall, up to the lid and back. Faces that two drops of different
/// speeds share once drove both, until they moved at 10 km/s.
TEST(Splash, GainsNoEnergy) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a minute under sanitizers, for code that other tests run as well";
#endif
  Scene s = plane(1, 1, 1.0 / 122, 1.4);
  add_body(s, "column", BodyKind::water, {0, 0, 0}, {0.25, 0.5, 0});
  s.output.frame_interval = 1.4;
  s.output.series_interval = 0.02;
  const test::Recorded r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_EQ(r.report.ledger.retries, 0);
  const std::vector<double> energy = r.results.series("ledger.energy");
  ASSERT_GT(energy.size(), 60u);
  for (std::size_t i = 1; i < energy.size(); ++i)
    EXPECT_LT(energy[i], 1.01 * energy[i - 1]) << "sample " << i;
  for (const double speed : r.results.series("max_speed")) EXPECT_LT(speed, 20);
}

}  // namespace
}  // namespace quicksand

// Tractions on soil: the stress right below the surface, wherever its points lie in their cells.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

/// An elastic block (ν = 0) without weight between smooth walls, loaded over half the run.
Scene block(double traction, double duration) {
  Scene s = plane(0.1, 0.8, 0.05, duration);
  s.gravity = {0, 0, 0};
  s.domain.sides[2].kind = SideKind::symmetry;  // holds it down in tension
  add_body(s, "block", BodyKind::soil, {0, 0, 0}, {0.1, 0.5, 0});
  s.soils["sand"].porosity = 0.7;
  s.soils["sand"].model = {.law = SoilLaw::linear_elastic, .young_modulus = 1e6};
  s.initial.stress = InitialStress::zero;
  Load load;
  load.name = "load", load.body = "block", load.traction = {0, traction, 0}, load.ramp = duration / 2;
  s.loads = {load};
  s.numerics.pic_rate = 100;  // hardly any swing is left
  s.output.frame_interval = duration / 20;
  return s;
}

/// Largest difference of the vertical stress from the load in the uppermost cell of the start, as part of the
/// full load.
double surface_error(const Scene& s) {
  const Recorded r = record(s);
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const double traction = s.loads[0].traction[1];
  double worst = 0;
  for (const Frame& frame : r.results.frames) {
    const double load = traction * std::min(1.0, frame.time / s.loads[0].ramp);
    if (frame.time < 0.1 * s.loads[0].ramp) continue;  // the swing of the start
    const auto &stress = field(frame, "effective_stress"), &moved = field(frame, "displacement");
    for (std::size_t p = 0; p < frame.points(); ++p)
      if (frame.position[3 * p + 1] - moved[3 * p + 1] > 0.45)
        worst = std::max(worst, std::abs(stress[4 * p + 1] - load) / std::abs(traction));
  }
  return worst;
}

TEST(SurfaceLoads, AreBorneRightBelowTheSurface) { EXPECT_LT(surface_error(block(-100, 2)), 0.005); }

/// Points have come to lie anywhere in their cells, up to 1½ times as dense and as far apart.
TEST(SurfaceLoads, AreBorneAtLargeStrain) {
  EXPECT_LT(surface_error(block(-4e5, 4)), 0.04);
  EXPECT_LT(surface_error(block(2e5, 4)), 0.04);
}

}  // namespace
}  // namespace quicksand::test

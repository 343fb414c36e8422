// Collapse of a column of water twice as high as wide: J. C. Martin and W. J. Moyce, Phil. Trans. R. Soc. A
// 244 (1952) 312. Z = front/a over T = t √(2g/a).

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"
#include "tests/verification/dimensions.hpp"

namespace quicksand::test {
namespace {

constexpr double kWidth = 0.1, kGravity = 9.81;  // cases/dam-break
const std::vector<double> kMeasuredT{0.84, 1.19, 1.63, 1.98, 2.32, 2.65, 2.98, 3.33},
    kMeasuredZ{1.22, 1.44, 1.89, 2.33, 2.78, 3.22, 3.67, 4.11};
/// Where the front runs evenly: slope of the measured points from Z = 2.33 to 4.11.
constexpr double kFirstZ = 2.33, kLastZ = 4.11, kSlope = 1.319;

double slope(const std::vector<double>& t, const std::vector<double>& z) {
  double n = 0, st = 0, sz = 0, stt = 0, stz = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (z[i] < kFirstZ || z[i] > kLastZ) continue;
    n += 1, st += t[i], sz += z[i], stt += t[i] * t[i], stz += t[i] * z[i];
  }
  return (n * stz - st * sz) / (n * stt - st * st);
}

/// Z over T of the foremost point.
Curve front(const Scene& scene, const Recorded& r) {
  Curve c{"Front", "T = t √(2g/a)", "Z", "", {}, {}, kMeasuredZ, kMeasuredT};
  const double half_spacing = 0.5 * scene.cell_size() / scene.numerics.points_per_cell;
  for (const Frame& frame : r.results.frames) {
    double x = 0;
    for (std::size_t p = 0; p < frame.points(); ++p) x = std::max<double>(x, frame.position[3 * p]);
    c.x.push_back(frame.time * std::sqrt(2 * kGravity / kWidth));
    c.result.push_back((x + half_spacing) / kWidth);
  }
  return c;
}

/// Drops may touch walls; in sheets of a few cells the volume below the surface is known to 2 %.
constexpr double kSheetVolume = 0.02;
constexpr LedgerLimits kSplash{1e-9, kSheetVolume, true};

/// On a smooth floor the front is 5 to 6 % too fast on any grid; no slip acts through half a cell and brings
/// it nearer the coarser the cells are.
void dam_break_page(double factor, const std::string& size) {
  Page page("dam-break", size);
  Scene scene = load_case("dam-break", factor);
  Curve rough = front(scene, page.run(scene, kSplash, "no slip"));
  scene.domain.sides[2].kind = SideKind::slip;
  Curve smooth = front(scene, page.run(scene, kSplash, "smooth"));
  rough.label = size + ", no slip", smooth.label = size + ", smooth";
  page.near("slope of the front", slope(rough.x, rough.result), kSlope, 0.03, "dZ/dT");
  page.missed_near("slope of the front, smooth floor", slope(smooth.x, smooth.result), kSlope, 0.03, 0.07,
                   "dZ/dT");
  page.curve(rough), page.curve(smooth);
}

TEST(DamBreak, FrontRunsAsMeasured) {
  dam_break_page(2, "cells of a/10");
  dam_break_page(1, "cells of a/20");
}

/// The same column in a channel a fifth of its width deep between smooth sides.
TEST(DamBreak, FrontRunsInSpaceAsInThePlane) {
  const Scene scene = load_case("dam-break", 2);
  Page page("dam-break", "cells of a/10, space");
  const Scene deep = in_space(scene, 0.2 * kWidth);
  Curve space = front(deep, page.run(deep, kSplash));
  const Curve plane = front(scene, record(scene));
  page.near("slope of the front", slope(space.x, space.result), kSlope, 0.03, "dZ/dT");
  page.near("slope of the front against the plane's", slope(space.x, space.result),
            slope(plane.x, plane.result), 0.01, "dZ/dT");
  page.curve(space);
}

}  // namespace
}  // namespace quicksand::test

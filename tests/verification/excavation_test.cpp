// A pit dug beside a sheet pile while its water is lowered: the steady seepage in the end against Laplace's
// equation on a fine lattice. See cases/excavation/README.md.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/excavation.
constexpr double kWidth = 1.4, kPile = 0.5, kToe = 0.4, kGround = 0.8, kFloor = 0.6, kLake = 0.9,
                 kPermeability = 1e-3;
/// The gradient is infinite at the toe; heads are compared at least so many cells from it.
constexpr double kFromToe = 2;

/// ∇²h = 0 in the final ground by successive over-relaxation, five-point formula: h = kLake under the pond,
/// kFloor on the pit's floor, no flow through the rest of the outline and the pile.
class Seepage {
 public:
  explicit Seepage(double spacing)
      : d_(spacing), nx_(count(kWidth)), ny_(count(kGround)), head_(nx_ * ny_, 0.5 * (kLake + kFloor)) {
    const double factor = 2 / (1 + std::numbers::pi / nx_);
    for (int sweep = 0; sweep < 10 * nx_; ++sweep)
      for (int j = 0; j < ny_; ++j)
        for (int i = 0; i < nx_; ++i) relax(i, j, factor);
  }
  double at(double x, double y) const {
    return head_[index(static_cast<int>(x / d_), static_cast<int>(y / d_))];
  }
  /// Under the pile towards the pit, m²/s.
  double flow() const {
    double sum = 0;
    for (int j = 0; j < count(kToe); ++j)
      sum += head_[index(count(kPile), j)] - head_[index(count(kPile) - 1, j)];
    return kPermeability * sum;
  }

 private:
  int count(double length) const { return static_cast<int>(std::lround(length / d_)); }
  std::size_t index(int i, int j) const { return static_cast<std::size_t>(j) * nx_ + i; }
  bool soil(int i, int j) const {
    return i >= 0 && i < nx_ && j >= 0 && j < ny_ && (i >= count(kPile) || j < count(kFloor));
  }
  void relax(int i, int j, double factor) {
    if (!soil(i, j)) return;
    double sum = 0, weight = 0;
    const auto add = [&](double head, double w) { sum += w * head, weight += w; };
    const bool at_pile = j >= count(kToe);
    if (soil(i - 1, j) && !(at_pile && i == count(kPile))) add(head_[index(i - 1, j)], 1);
    if (soil(i + 1, j) && !(at_pile && i + 1 == count(kPile))) add(head_[index(i + 1, j)], 1);
    if (soil(i, j - 1)) add(head_[index(i, j - 1)], 1);
    if (soil(i, j + 1))
      add(head_[index(i, j + 1)], 1);
    else
      add(i < count(kPile) ? kFloor : kLake, 2);  // the surface is half a spacing away
    head_[index(i, j)] += factor * (sum / weight - head_[index(i, j)]);
  }

  double d_;
  int nx_, ny_;
  std::vector<double> head_;
};

/// Largest error of the head at water points of the ground, of the difference of levels.
double head_error(const Frame& frame, const Seepage& seepage, double h, Curve& below, Curve& outside) {
  const auto& head = field(frame, "head");
  double worst = 0;
  for (std::size_t i = 0; i < frame.points(); ++i) {
    const double x = frame.position[3 * i], y = frame.position[3 * i + 1];
    if (frame.phase[i] != 1 || y > (x < kPile ? kFloor : kGround)) continue;
    const double expected = seepage.at(x, y);
    if (std::hypot(x - kPile, y - kToe) >= kFromToe * h)
      worst = std::max(worst, std::abs(head[i] - expected) / (kLake - kFloor));
    Curve* profile = std::abs(x - 0.25) < h / 4 ? &below : std::abs(x - 0.6) < h / 4 ? &outside : nullptr;
    if (!profile) continue;
    profile->x.push_back(y), profile->result.push_back(head[i]), profile->reference.push_back(expected);
  }
  return worst;
}

void excavation_page(double factor, const std::string& size, double flow_tolerance) {
  Page page("excavation", size);
  const Scene scene = load_case("excavation", factor);
  const Recorded r = page.run(scene);
  const Ledger& l = r.report.ledger;
  EXPECT_NEAR(l.soil_removed, 2 * 0.6 * 2650 * kPile * 0.1, 1e-6);
  EXPECT_GT(l.water_removed, 0.9 * 2 * 0.4 * 1000 * kPile * 0.1);  // some had drained to the sump
  EXPECT_GT(l.water_out, 0.01);

  const Seepage seepage(0.00625);
  const double coarse = Seepage(0.0125).flow(),
               flow = 2 * seepage.flow() - coarse;  // of first order at the toe
  Curve below{"Head under the pit, x = 0.25 m", "height (m)", "head (m)", "", {}, {}};
  Curve outside{"Head behind the pile, x = 0.6 m", "height (m)", "head (m)", "", {}, {}};
  page.error("head, more than 2 cells from the toe",
             head_error(r.results.frames.back(), seepage, scene.cell_size(), below, outside), 0.02,
             "of the difference");
  page.near("flow under the pile", -r.results.last("section.under the pile"), flow, flow_tolerance,
            "m³/s per metre");
  page.error("speed of grains in the end", r.results.last("max_soil_speed"), 1e-5, "m/s");
  page.value("heave of the ground, largest", r.results.last("body.ground.largest_displacement"), "m");
  page.curve(below), page.curve(outside);
  Curve history{"Flow under the pile", "t (s)", "litres per s and m", size, r.results.times, {}};
  for (const double q : r.results.series("section.under the pile")) history.result.push_back(-1e3 * q);
  page.curve(history);
}

TEST(Excavation, EndsInTheSeepageUnderThePile) { excavation_page(2, "cells of 50 mm", 0.05); }
TEST(SlowExcavation, EndsInTheSeepageUnderThePile) { excavation_page(1, "cells of 25 mm", 0.03); }

}  // namespace
}  // namespace quicksand::test

// G. Thiem's well in a confined layer of thickness H: Q = k H (h2 − h1)/ln(r2/r1) per radian,
// h = h1 + (h2 − h1) ln(r/r1)/ln(r2/r1).

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// As in cases/thiem.
constexpr double kWell = 0.5, kFar = 2.5, kThickness = 0.2, kPermeability = 1e-3, kWellHead = 1, kFarHead = 2;

double head(double r) {
  return kWellHead + (kFarHead - kWellHead) * std::log(r / kWell) / std::log(kFar / kWell);
}

struct Errors {
  double head = 0, flow = 0;
};

Errors well(int cells, double held_to) {
  Page page("thiem", std::to_string(cells) + " cells");
  const Recorded r = page.run(load_case("thiem", 40.0 / cells));
  const Frame& last = r.results.frames.back();
  const auto& h = field(last, "head");
  Errors e;
  Curve drawdown{"Head", "r, m", "h, m", "", {}, {}};
  for (std::size_t i = 0; i < last.points(); ++i) {
    if (last.phase[i] != 0) continue;
    const double at = last.position[3 * i];
    e.head = std::max(e.head, std::abs(h[i] - head(at)) / (kFarHead - kWellHead));
    if (last.position[3 * i + 1] > kThickness / 8) continue;
    drawdown.x.push_back(at), drawdown.result.push_back(h[i]), drawdown.reference.push_back(head(at));
  }
  const double flow = kPermeability * kThickness * (kFarHead - kWellHead) / std::log(kFar / kWell);
  e.flow = std::abs(r.results.last("section.midway") / -flow - 1);
  page.curve(drawdown);
  page.error("head at all points", e.head, held_to, "of the difference");
  page.near("flow to the well per radian", -r.results.last("section.midway"), flow, held_to, "m³/s");
  page.near("flow out of the well", -r.results.last("reservoir.well.inflow"), flow, held_to, "m³/s");
  return e;
}

TEST(Thiem, ConvergesToTheWellsFlow) {
  well(20, 0.01);
  well(40, 0.01);
}

}  // namespace
}  // namespace quicksand::test

// Confined seepage under a thin pile that reaches half way down a layer: the conformal map of M. E. Harr,
// Groundwater and Seepage (1962). See cases/sheet-pile/README.md for what is measured where.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/sheet-pile, lengths in m.
constexpr double kLayer = 1, kEmbedded = 0.5, kTip = kLayer - kEmbedded, kHead = 0.25, kPermeability = 1e-3;
/// q/(k h), i_E s/h, and the mean head at the tip's level within s/2 of the pile over h.
constexpr double kFlow = 0.5, kExit = 0.299535, kPrism = 0.341359;

/// Head on the pile's downstream face at `depth`, over h: ½ F(ψ, m)/K(m), sin ψ = sin(πd/2T)/m,
/// m = sin(πs/2T). Upstream it is one less that.
double head_on_pile(double depth) {
  const double m = std::sin(std::numbers::pi * kEmbedded / (2 * kLayer));
  const double sine = std::min(1.0, std::sin(std::numbers::pi * depth / (2 * kLayer)) / m);
  return 0.5 * std::ellint_1(m, std::asin(sine)) / std::comp_ellint_1(m);
}

struct Seepage {
  double flow = 0;             ///< over k h, under the pile
  double left = 0, right = 0;  ///< over k h, down on its left and up on its right
  double change = 0;           ///< of the flow from one quarter of the run to the last, relative
  double exit = 0;             ///< i_E s/h
  double second = 0;           ///< head in the second cell from the surface beside the pile, over h
  double prism = 0;            ///< over h
  double on_pile = 0;          ///< largest error of the head beside the pile, over h
  long passed = 0;  ///< water points on the other side of the pile than at the start, above its tip
};

/// Mean over the last quarter of a run, or the one before: elastic ground rings on a little.
double late_mean(const Recorder& r, const std::string& name, std::size_t quarters_before_end = 1) {
  const auto all = r.series(name);
  const std::size_t quarter = all.size() / 4, first = all.size() - quarters_before_end * quarter;
  return std::accumulate(&all[first], &all[first] + quarter, 0.0) / static_cast<double>(quarter);
}

/// A head probe at the middle of a cell, where the head shown is the cell's own and not interpolated.
void add_probe(Scene& s, const std::string& name, int column, double row) {
  const double h = s.cell_size();
  s.output.probes.push_back({name, {(column + 0.5) * h, (row + 0.5) * h, 0}, "head"});
}
std::string exit_probe(int column, int down) {
  return "exit " + std::to_string(column) + std::to_string(down);
}
std::string prism_probe(int column, bool above) {
  return (above ? "prism above " : "prism below ") + std::to_string(column);
}

/// Probes in the four cells next to the pile and the downstream surface, and in both rows of cells at the
/// tip's level within s/2 of the pile.
void add_probes(Scene& s, int cells) {
  for (const int column : {0, 1})
    for (const int down : {0, 1}) add_probe(s, exit_probe(column, down), column, cells - 1 - down);
  for (int column = 0; column < cells / 4; ++column)
    for (const bool above : {false, true})
      add_probe(s, prism_probe(column, above), column, cells / 2 - (above ? 0 : 1));
}

/// At the surface the head is odd in depth, a y + b y³, beside the pile even in x.
void measure_probes(const Recorder& r, int cells, double datum, Seepage& out) {
  const auto head = [&](const std::string& name) { return (late_mean(r, "probe." + name) - datum) / kHead; };
  const auto gradient = [&](int column) {
    return (27 * head(exit_probe(column, 0)) - head(exit_probe(column, 1))) * cells / (12 * kLayer);
  };
  out.exit = kEmbedded * (9 * gradient(0) - gradient(1)) / 8;
  out.second = head(exit_probe(0, 1));
  for (int column = 0; column < cells / 4; ++column)
    for (const bool above : {false, true})
      out.prism += head(prism_probe(column, above)) / (2.0 * (cells / 4));
}

/// The pile's end is left out: within a tenth of s the head changes as the root of the distance.
constexpr double kNearTip = 0.1 * kEmbedded;

void measure_points(const Frame& frame, double h, double datum, Seepage& out, Curve* beside) {
  const auto& head = field(frame, "head");
  const auto& moved = field(frame, "displacement");
  for (std::size_t p = 0; p < frame.points(); ++p) {
    if (frame.phase[p] != 1) continue;
    const double x = frame.position[3 * p], y = frame.position[3 * p + 1], value = (head[p] - datum) / kHead;
    const double start = x - moved[3 * p];
    if (start * x < 0 && y > kTip && y - moved[3 * p + 1] > kTip) ++out.passed;
    if (std::abs(x) > 0.5 * h || y < kTip || y > kLayer) continue;
    const double depth = kLayer - y, exact = head_on_pile(depth), expected = x > 0 ? exact : 1 - exact;
    if (y > kTip + kNearTip) out.on_pile = std::max(out.on_pile, std::abs(value - expected));
    if (beside) beside->x.push_back(depth), beside->result.push_back(value);
  }
}

/// `datum` is the level downstream.
Seepage measure(const Recorded& r, int cells, double datum, Curve* beside = nullptr) {
  Seepage out;
  const auto flow = [&](const std::string& section, std::size_t quarters = 1) {
    return late_mean(r.results, "section." + section, quarters) / (kPermeability * kHead);
  };
  out.flow = flow("under the pile");
  out.change = std::abs(out.flow / flow("under the pile", 2) - 1);
  out.left = -flow("left of the pile");
  out.right = flow("right of the pile");
  measure_probes(r.results, cells, datum, out);
  measure_points(r.results.frames.back(), kLayer / cells, datum, out, beside);
  return out;
}

Seepage fixed_page(int cells, double held_to) {
  const std::string size = std::to_string(cells) + " cells";
  Page page("sheet-pile", size);
  Scene scene = load_case("sheet-pile", 80.0 / cells);
  add_probes(scene, cells);
  const Recorded r = page.run(scene);
  Curve beside{"Head beside the pile", "depth, m", "head/h", size, {}, {}};
  for (int i = -50; i <= 50; ++i) {  // down upstream, up downstream
    const double depth = kEmbedded * (1 - std::abs(i) / 50.0), exact = head_on_pile(depth);
    beside.reference_x.push_back(depth), beside.reference.push_back(i < 0 ? 1 - exact : exact);
  }
  const Seepage s = measure(r, cells, kLayer, &beside);
  page.near("flow under the pile, q/(k h)", s.flow, kFlow, held_to, "–");
  page.near("exit gradient beside the pile, i s/h", s.exit, kExit, held_to, "–");
  page.near("mean head in Terzaghi's prism", s.prism, kPrism, held_to, "h");
  page.error("head on both faces of the pile", s.on_pile, held_to, "h");
  const double lost = std::max(std::abs(s.left / s.flow - 1), std::abs(s.right / s.flow - 1));
  page.error("flow beside the pile less flow under it", lost, 1e-3, "of it");
  EXPECT_EQ(s.passed, 0);
  EXPECT_LT(s.change, 1e-3);
  page.curve(beside);
  return s;
}

/// The error comes from the pile's end, where the velocity is infinite, and is first order: half per halving.
void expect_halved(const Seepage& coarse, const Seepage& fine) {
  EXPECT_NEAR((fine.flow - kFlow) / (coarse.flow - kFlow), 0.5, 0.05);
  EXPECT_NEAR((fine.exit - kExit) / (coarse.exit - kExit), 0.5, 0.05);
  EXPECT_NEAR((fine.prism - kPrism) / (coarse.prism - kPrism), 0.5, 0.05);
}

TEST(SheetPile, ConvergesToTheConformalMap) {
  const Seepage coarse = fixed_page(20, 0.05), middle = fixed_page(40, 0.025), fine = fixed_page(80, 0.02);
  expect_halved(coarse, middle);
  expect_halved(middle, fine);
}

TEST(SlowSheetPile, ConvergesToTheConformalMap) { fixed_page(160, 0.01); }

/// The same layer with grains that move, linear elastic, under ponds 0.25 m deep; the head upstream rises in
/// 1 s.
Scene elastic(int cells) {
  constexpr double kPond = 0.25;
  Scene s = load_case("sheet-pile", 80.0 / cells);
  add_probes(s, cells);
  s.domain.max[1] = s.walls[0].line->to[1] = kLayer + kPond;
  s.bodies[0].fixed = false;
  for (const double side : {-1.0, 1.0}) {
    Body pond;
    pond.name = side < 0 ? "left pond" : "right pond";
    pond.kind = BodyKind::water;
    pond.region = box(std::min(0.0, 3 * side), kLayer, std::max(0.0, 3 * side), kLayer + kPond);
    s.bodies.push_back(pond);
  }
  for (Reservoir& reservoir : s.reservoirs) {
    reservoir.line.from[1] = reservoir.line.to[1] = kLayer + kPond;
    reservoir.head = kLayer + kPond;
  }
  s.stages[0].duration = s.output.frame_interval = 3;
  s.stages[0].heads = {{"upstream", kLayer + kPond + kHead}};
  s.stages[0].heads_ramp = 1;
  s.output.series_interval = 0.01;
  return s;
}

void elastic_page(int cells) {
  Page page("sheet-pile", std::to_string(cells) + " cells, elastic");
  Scene held = load_case("sheet-pile", 80.0 / cells);
  add_probes(held, cells);
  const Scene moving = elastic(cells);
  const Seepage a = measure(page.run(held, {}, "held"), cells, kLayer),
                b = measure(page.run(moving, {}, "elastic"), cells, moving.reservoirs[1].head);
  page.near("flow under the pile, against held grains", b.flow, a.flow, 0.01, "k h");
  page.near("mean head in Terzaghi's prism, against held grains", b.prism, a.prism, 0.01, "h");
  page.near("head in the second cell at the exit, against held grains", b.second, a.second, 0.01, "h");
  EXPECT_EQ(b.passed, 0);
  EXPECT_LT(b.change, 5e-3);
}

TEST(SheetPile, ElasticGroundSeepsTheSame) { elastic_page(12); }
TEST(SlowSheetPile, ElasticGroundSeepsTheSame) { elastic_page(20); }

}  // namespace
}  // namespace quicksand::test

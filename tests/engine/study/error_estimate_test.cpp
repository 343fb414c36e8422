#include "engine/study/error_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/plan/companions.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

/// f(h) = 3 + 2 hᵖ on h = 0.1 and on cells `ratio` times as large.
GridDifference power(double order, double ratio) {
  const auto f = [&](double h) { return 3 + 2 * std::pow(h, order); };
  return {std::abs(f(0.1) - f(0.1 * ratio)), ratio};
}

TEST(Richardson, FindsErrorAndOrderOfAPowerFromThreeGrids) {
  for (const double order : {0.7, 1.0, 2.0, 3.5})
    for (const auto& [coarser, finer] : {std::pair{2.0, 0.5}, {1.5, 2.0 / 3}, {2.0, 0.75}}) {
      const DiscretisationError e = richardson(power(order, coarser), power(order, finer));
      EXPECT_EQ(e.basis, OrderBasis::observed);
      EXPECT_NEAR(e.order, order, 1e-6);
      EXPECT_NEAR(e.error, 2 * std::pow(0.1, order), 1e-9);
    }
}

TEST(Richardson, TwoGridsComeWithinAFactorThreeForUsualOrders) {
  for (const double order : {0.75, 1.0, 2.0, 2.6}) {
    const double truth = 2 * std::pow(0.1, order);
    const DiscretisationError e = richardson(power(order, 2), {});
    EXPECT_EQ(e.basis, OrderBasis::assumed);
    EXPECT_LT(e.error, 3 * truth) << order;
    EXPECT_GT(e.error, truth / 3) << order;
  }
}

TEST(Richardson, SaysWhenThereIsNoOrder) {
  const DiscretisationError apart = richardson(GridDifference{1, 2}, GridDifference{2, 0.5});
  EXPECT_EQ(apart.basis, OrderBasis::not_asymptotic);
  EXPECT_DOUBLE_EQ(apart.error, 4);  // 2 / (1 − ½) of the finer pair
  EXPECT_EQ(richardson(GridDifference{4, 2}, GridDifference{1, 0.5}, false).basis,
            OrderBasis::not_asymptotic);
  EXPECT_EQ(richardson(GridDifference{0, 2}, GridDifference{0, 0.5}).error, 0);
}

TEST(Curves, AreComparedWhereBothAre) {
  const Curve a{"a", "m", 0, {0, 1, 2}, {0, 1, 2}}, b{"a", "m", 0, {0, 2, 4}, {0.5, 2.5, 4}};
  EXPECT_DOUBLE_EQ(b.at(1), 1.5);
  EXPECT_DOUBLE_EQ(b.at(9), 4);
  EXPECT_DOUBLE_EQ(distance(a, b), 0.5);
  EXPECT_DOUBLE_EQ(a.range(), 2);
}

Scene watched() {
  Scene scene = test::plane(0.4, 0.6, 0.05, 0.02);
  test::add_body(scene, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  scene.numerics.error_estimate = ErrorEstimate::coarser;
  return scene;
}

TEST(Companions, AreOnCellsThatFit) {
  Scene scene = watched();
  const Companions found = companions(scene);
  ASSERT_TRUE(found.coarser);
  EXPECT_FALSE(found.finer);
  EXPECT_GT(found.coarser->scene.cell_size(), scene.cell_size());
  EXPECT_EQ(found.coarser->scene.numerics.error_estimate, ErrorEstimate::none);
  scene.numerics.error_estimate = ErrorEstimate::none;
  EXPECT_FALSE(companions(scene).coarser);
}

/// A bed that ends on half a cell would be half a part of a cell lower on cells twice as large.
TEST(Companions, HoldTheSameBodies) {
  Scene scene = test::plane(0.4, 0.6, 0.05, 0.02);
  test::add_body(scene, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.425, 0});
  scene.numerics.error_estimate = ErrorEstimate::coarser;
  EXPECT_FALSE(companions(scene).coarser);
  const auto fault = no_companion(scene);
  ASSERT_TRUE(fault);
  EXPECT_NE(fault->detail.find("ends of the bodies"), std::string::npos) << fault->detail;
  scene.numerics.error_estimate = ErrorEstimate::finer;
  EXPECT_FALSE(companions(scene).coarser);
  ASSERT_TRUE(companions(scene).finer);
  EXPECT_EQ(companions(scene).finer->ratio, 0.5);
  scene.numerics.error_estimate = ErrorEstimate::coarser;
  scene.bodies[0].region.max[1] = 0.43;  // between points: rounded on every grid
  EXPECT_TRUE(companions(scene).coarser);
}

TEST(ErrorEstimate, ComparesEveryBody) {
  const Scene scene = watched();
  HistorySink history;
  RunMonitor monitor;
  const RunReport report = run(scene, history, monitor, {1});
  ASSERT_EQ(report.status, RunStatus::succeeded);
  const ErrorEstimateReport estimate = estimate_error(scene, report, history, monitor, {1});
  EXPECT_EQ(estimate.missing, "");
  ASSERT_EQ(estimate.companions.size(), 1u);
  EXPECT_EQ(estimate.companions[0].status, RunStatus::succeeded);
  ASSERT_FALSE(estimate.figures.empty());
  for (const FigureError& figure : estimate.figures) {
    EXPECT_EQ(figure.history.basis, OrderBasis::assumed) << figure.name;
    EXPECT_TRUE(std::isfinite(figure.history.error)) << figure.name;
  }
}

/// Of two inflows of which one agrees by accident, that one is told as uncertain as both in the mean;
/// observed orders and other figures are left alone.
TEST(ErrorEstimate, DoubtsInflowsThatAgreeByAccident) {
  const auto figure = [](const char* name, double error, OrderBasis basis) {
    FigureError f{name, "m³/s", 0, 0, error < 0.5 ? 1.0 : 0.0, {}, {}};
    f.history = {error, kAssumedOrder, basis};
    return f;
  };
  std::vector<FigureError> figures{
      figure("reservoir.well.inflow", 0, OrderBasis::assumed),
      figure("reservoir.far.inflow", 0.1, OrderBasis::assumed),
      figure("reservoir.side.inflow", 0.001, OrderBasis::observed),
      figure("probe.reservoir.inflow", 0.02, OrderBasis::assumed),
      figure("reservoir.shut.inflow", 0.5, OrderBasis::assumed),  // nothing ever flows
  };
  doubt_accidents(figures);
  const double expected[] = {std::sqrt(0.005), 0.1, 0.001, 0.02, 0.5};
  for (std::size_t k = 0; k < figures.size(); ++k)
    EXPECT_NEAR(figures[k].history.error, expected[k], 1e-15) << figures[k].name;
}

TEST(ErrorEstimate, IsMissingAfterAFailure) {
  RunReport report;
  report.status = RunStatus::failed;
  RunMonitor monitor;
  EXPECT_NE(estimate_error(watched(), report, HistorySink(), monitor, {1}).missing, "");
}

}  // namespace
}  // namespace quicksand

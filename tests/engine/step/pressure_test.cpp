// The pressure system, and the mass balance that it has to leave behind.

#include "engine/step/pressure.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "engine/step/phases.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

/// State in the midst of motion, before the pressure is solved for.
template <int D>
State<D> moving_state(const Scene& scene, double dt) {
  State<D> s = make_state<D>(scene);
  advance_times(s, 60, dt);
  points_to_faces(s);
  find_surface(s);
  s.pressure_old = s.pressure;
  predict_velocities(s, dt);
  return s;
}

template <int D>
void expect_symmetric_and_solved(const Scene& scene, double dt) {
  State<D> s = moving_state<D>(scene, dt);
  const PressureReport report = solve_pressure(s, dt);
  const PressureSystem<D>& m = s.pressure_system;
  const int rows = static_cast<int>(m.cell.size());
  ASSERT_GT(rows, 20);
  EXPECT_EQ(report.unknowns, rows);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.residual, s.constants.pressure_tolerance);

  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, rows);
  for (int r = 0; r < rows; ++r) {
    a(r, r) = m.matrix.diagonal[r];
    int color = 0;
    for (const int c : s.grid.cell(m.cell[r])) color ^= c & 1;
    EXPECT_EQ(color == 0, r < m.even);
    for (int k = 0; k < 2 * D; ++k) {
      const int d = k / 2, j = m.neighbor[k][r];
      if (j < 0) {
        EXPECT_EQ(m.matrix.coupling[k][r], 0);
        continue;
      }
      EXPECT_EQ(m.cell[j], m.cell[r] + (k % 2 ? 1 : -1) * s.grid.stride[d]);
      EXPECT_EQ(m.neighbor[k ^ 1][j], r);  // the neighbours know each other
      EXPECT_FALSE(s.water_walls.closed(d, m.cell[k % 2 ? j : r]));
      EXPECT_GT(m.matrix.coupling[k][r], 0);
      a(r, j) -= m.matrix.coupling[k][r];
    }
  }
  EXPECT_EQ((a - a.transpose()).cwiseAbs().maxCoeff(), 0);
  for (int r = 0; r < rows; ++r)  // diagonally dominant: storage and the free surface only add
    EXPECT_GE(a(r, r) - (a.row(r).cwiseAbs().sum() - a(r, r)), -1e-12 * a(r, r));
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(a).info(), Eigen::Success);  // positive definite

  const Eigen::Map<const Eigen::VectorXd> x(m.solution.data(), rows), b(m.rhs.data(), rows);
  EXPECT_LT((a * x - b).cwiseAbs().maxCoeff(), 2 * s.constants.pressure_tolerance * b.cwiseAbs().maxCoeff());
  const Eigen::VectorXd direct = a.llt().solve(b);
  EXPECT_LT((x - direct).cwiseAbs().maxCoeff(), 1e-3 * direct.cwiseAbs().maxCoeff());
}

TEST(Pressure, MatrixIsSymmetricAndSolved2D) { expect_symmetric_and_solved<2>(collapse(), 2e-4); }

TEST(Pressure, MatrixIsSymmetricAndSolved3D) {
  Scene s = space({0.6, 0.5, 0.2}, 0.05);
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.2, 0.2});
  add_body(s, "pool", BodyKind::water, {0.2, 0, 0}, {0.3, 0.3, 0.2});
  expect_symmetric_and_solved<3>(s, 2e-4);
}

/// −∇·q of a cell from the faces, 1/s; faces on walls carry nothing.
template <int D>
double inflow(const State<D>& s, int i) {
  double sum = 0;
  for (int d = 0; d < D; ++d)
    for (int side : {0, 1}) {
      const int face = i + side * s.grid.stride[d];
      if (!s.water_walls.closed(d, face))
        sum += (1 - 2 * side) * s.flow[d][face].flux(s.speeds[d][face]) * s.grid.inverse_h;
    }
  return sum;
}

TEST(Pressure, CorrectedVelocitiesBalanceTheMass) {
  Scene scene = collapse();
  scene.numerics.drift_time = 0;
  scene.numerics.pressure_tolerance = 1e-10;
  scene.water.bulk_modulus = 1e7;  // storage that counts
  const double dt = 2e-4;
  State<2> s = moving_state<2>(scene, dt);
  double before = 0;
  for_each_cell(s.grid, [&](int i, const Cell<2>&) {
    if (s.cell[i].wet()) before = std::max(before, std::abs(inflow(s, i)));
  });
  ASSERT_TRUE(advance(s, dt).pressure.converged);
  double open = 0;
  for_each_cell(s.grid, [&](int i, const Cell<2>&) {
    if (!s.cell[i].wet()) return;
    const double stored =
        s.cell[i].n * s.constants.water_compliance / dt * (s.pressure[i] - s.pressure_old[i]);
    open = std::max(open, std::abs(stored - inflow(s, i)));
  });
  EXPECT_GT(before, 0.01);
  EXPECT_LT(open, 1e-6 * before);
}

/// Iterations of a step in which the pressure changes as it did in the last one, or once that is forgotten.
TEST(Pressure, BeginsFromWhatItWillBe) {
  const double dt = 2e-4;
  State<2> s = make_state<2>(collapse());
  advance_times(s, 60, dt);
  State<2> forgetful = make_state<2>(collapse());
  advance_times(forgetful, 60, dt);
  forgetful.pressure_old = Field<double>(s.grid.count());
  const int with = advance(s, dt).pressure.iterations, without = advance(forgetful, dt).pressure.iterations;
  EXPECT_LT(with, without);
}

/// A pool with 10 % too much water in its middle, sloshing at `speed`; the largest excess after 2 s.
double excess_after(BodyKind kind, double speed) {
  Scene scene = plane(1, 1, 0.1);
  add_body(scene, "pool", kind, {0, 0, 0}, {1, 0.8, 0});
  scene.bodies[0].velocity = {speed, 0, 0};
  scene.numerics.drift_time = 0.05;
  State<2> s = make_state<2>(scene);
  for (std::size_t p = 0; p < s.water.size(); ++p)
    if (std::abs(s.water.x[p][0] - 0.5) < 0.2 && std::abs(s.water.x[p][1] - 0.4) < 0.2)
      s.water.mass[p] *= 1.1;
  advance_times(s, 2000, 1e-3);
  double largest = 0;
  for (const CellState& c : s.cell) largest = std::max(largest, c.excess);
  return largest;
}

TEST(Pressure, OverfullCellsArePushedApartAsFastAsTheWaterMoves) {
  // At rest among grains nothing is fed back: seepage would follow how unevenly the points lie.
  EXPECT_GT(excess_after(BodyKind::saturated_soil, 0), 0.03);
  // Water alone does not stay compressed, down to the dead band.
  EXPECT_LT(excess_after(BodyKind::water, 0), 0.021);
  EXPECT_LT(excess_after(BodyKind::water, 1), 0.04);
}

TEST(Pressure, NoWaterNoUnknowns) {
  Scene scene = plane(1, 1, 0.1);
  add_body(scene, "lump", BodyKind::soil, {0, 0, 0}, {0.5, 0.5, 0});
  State<2> s = make_state<2>(scene);
  const auto report = advance(s, 1e-4);
  EXPECT_EQ(report.pressure.unknowns, 0);
  EXPECT_TRUE(report.pressure.converged);
}

}  // namespace
}  // namespace quicksand

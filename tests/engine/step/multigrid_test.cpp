// Multigrid on the wet cells: symmetric, and as good on fine grids as on coarse ones.

#include "engine/step/multigrid.hpp"

#include <gtest/gtest.h>

#include <random>

#include "engine/step/conjugate_gradients.hpp"

namespace quicksand {
namespace {

/// Poisson's equation on the cells of an n^D box, of which `wet` says which take part: closed sides, p = 0
/// above. `beta(d, cell)` is the coupling of a cell to the one above it along d.
template <int D, class Wet, class Beta>
PressureSystem<D> system_on(const Grid<D>& grid, Wet&& wet, Beta&& beta) {
  PressureSystem<D> m;
  std::vector<int> row(grid.count(), -1);
  for (const int color : {0, 1}) {
    for_each_cell(grid, [&](int i, const Cell<D>& c) {
      int parity = 0;
      for (const int at : c) parity ^= at & 1;
      if (parity == color && wet(c)) row[i] = static_cast<int>(m.cell.size()), m.cell.push_back(i);
    });
    if (color == 0) m.even = static_cast<int>(m.cell.size());
  }
  const std::size_t rows = m.cell.size();
  m.resize(), m.change.clear();
  m.matrix.diagonal.assign(rows, 1e-9), m.solution.assign(rows, 0);
  for (auto& side : m.neighbor) side.assign(rows, -1);
  std::mt19937 random(1);
  for (std::size_t r = 0; r < rows; ++r) {
    m.rhs[r] = static_cast<double>(random()) / 4294967296.0 - 0.5;
    const Cell<D> c = grid.cell(m.cell[r]);
    for (int d = 0; d < D; ++d) {
      const int j = row[m.cell[r] + grid.stride[d]];
      const double b = beta(d, c);
      if (j < 0) {
        if (d == kUp) m.matrix.diagonal[r] += 2 * b;  // the surface
        continue;
      }
      m.neighbor[2 * d + 1][r] = j, m.neighbor[2 * d][j] = static_cast<int>(r);
      m.matrix.coupling[2 * d + 1][r] = m.matrix.coupling[2 * d][j] = b;
      m.matrix.diagonal[r] += b, m.matrix.diagonal[j] += b;
    }
  }
  return m;
}

template <int D>
Grid<D> cube(int n) {
  Cell<D> cells;
  cells.fill(n);
  return Grid<D>(Vec<D>{}, cells, 1.0 / n);
}

template <int D, class Wet, class Beta>
int iterations(int n, Wet&& wet, Beta&& beta) {
  const Grid<D> grid = cube<D>(n);
  PressureSystem<D> m = system_on(grid, wet, beta);
  Multigrid<D> multigrid;
  const PressureReport report = conjugate_gradients(grid, m, multigrid, 1e-8);
  EXPECT_TRUE(report.converged);
  std::vector<double> image(m.cell.size());
  multiply(m, m.solution, image);
  for (std::size_t r = 0; r < image.size(); ++r) EXPECT_NEAR(image[r], m.rhs[r], 2e-8);
  return report.iterations;
}

TEST(Multigrid, IterationsDoNotGrowWithTheGrid) {
  const auto all = [](const auto&) { return true; };
  const auto even = [](int, const auto&) { return 1.0; };
  const int coarse = iterations<2>(32, all, even), fine = iterations<2>(256, all, even);
  EXPECT_LE(coarse, 16);
  EXPECT_LE(fine, coarse * 5 / 4);
  EXPECT_LE(iterations<3>(32, all, even), 20);
}

TEST(Multigrid, HolesAndContrastsAreSolved) {
  // A wall with one gap, a ragged surface, layers 10⁶ apart in permeability.
  const auto wet = [](const Cell<2>& c) { return (c[0] != 30 || c[1] == 5) && c[1] < 50 + c[0] % 7; };
  const auto layered = [](int, const Cell<2>& c) { return c[1] / 9 % 2 ? 1.0 : 1e-6; };
  EXPECT_LE(iterations<2>(64, wet, layered), 80);
}

/// Gates that open and shut change the couplings of the same cells.
TEST(Multigrid, SameCellsWithOtherWalls) {
  const Grid<2> grid = cube<2>(16);
  Multigrid<2> multigrid;
  for (const double gate : {0.0, 1.0, 0.0}) {
    PressureSystem<2> m = system_on(
        grid, [](const auto&) { return true; },
        [&](int d, const Cell<2>& c) { return d == 0 && c[0] == 7 ? gate : 1.0; });
    if (gate == 0)
      for (std::size_t r = 0; r < m.cell.size(); ++r)
        if (grid.cell(m.cell[r])[0] == 7) m.neighbor[0][m.neighbor[1][r]] = -1, m.neighbor[1][r] = -1;
    EXPECT_LE(conjugate_gradients(grid, m, multigrid, 1e-8).iterations, 20);
    std::vector<double> image(m.cell.size());
    multiply(m, m.solution, image);
    for (std::size_t r = 0; r < image.size(); ++r) EXPECT_NEAR(image[r], m.rhs[r], 2e-8);
  }
}

/// 20: every level once; 100: some of them twice.
class MultigridCycle : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Cells, MultigridCycle, testing::Values(20, 100));

TEST_P(MultigridCycle, IsSymmetric) {
  const int cells = GetParam();
  const Grid<2> grid = cube<2>(cells);
  const auto wet = [&](const Cell<2>& c) { return c[0] + c[1] < cells * 5 / 3 && c[0] * c[1] != 30; };
  const PressureSystem<2> m =
      system_on(grid, wet, [](int d, const Cell<2>& c) { return 1.0 + d + c[0] % 3; });
  Multigrid<2> multigrid;
  multigrid.build(grid, m);
  ASSERT_GE(multigrid.levels(), 3u);
  const std::size_t n = m.cell.size();
  std::mt19937 random(2);
  std::vector<double> a(n), b(n), ma(n), mb(n);
  for (std::size_t i = 0; i < n; ++i)
    a[i] = static_cast<double>(random()) / 4294967296.0, b[i] = static_cast<double>(random()) / 4294967296.0;
  multigrid.apply(a, ma), multigrid.apply(b, mb);
  double amb = 0, bma = 0, ama = 0;
  for (std::size_t i = 0; i < n; ++i) amb += a[i] * mb[i], bma += b[i] * ma[i], ama += a[i] * ma[i];
  EXPECT_NEAR(amb, bma, 1e-10 * std::abs(amb));
  EXPECT_GT(ama, 0);
}

}  // namespace
}  // namespace quicksand

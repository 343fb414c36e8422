#include "engine/grid/stencil.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

#include "engine/grid/cell_kernel.hpp"

namespace quicksand {
namespace {

/// Centre of face `face` of component d, m.
template <int D>
Vec<D> face_place(const Grid<D>& grid, int d, int face) {
  Vec<D> x = grid.center(grid.cell(face));
  x[d] -= 0.5 * grid.h;
  return x;
}

template <int D>
Grid<D> some_grid() {
  Vec<D> low;
  Cell<D> count;
  for (int d = 0; d < D; ++d) low[d] = 0.3 - d, count[d] = 6 + d;
  return Grid<D>(low, count, 0.2);
}

/// Random places of a domain whose walls are all open.
template <int D, class F>
void at_random_places(const Grid<D>& grid, int count, F&& f) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(0, 1);
  for (int i = 0; i < count; ++i) {
    Vec<D> x;
    for (int d = 0; d < D; ++d) x[d] = grid.origin[d] + part(random) * grid.cells[d] * grid.h;
    f(x);
  }
}

template <int D, class Shape>
void expect_moments() {
  const Grid<D> grid = some_grid<D>();
  const Walls<D> open(grid);
  at_random_places(grid, 300, [&](const Vec<D>& x) {
    const PointKernel<D, Shape> kernel(grid, x);
    for (int d = 0; d < D; ++d) {
      double sum = 0;
      Vec<D> mean{}, gradient_sum{};
      std::array<Vec<D>, D> slope{};
      for_faces(grid, open, kernel, d, [&](int face, double w, double sign, const Vec<D>& g) {
        const Vec<D> at = face_place(grid, d, face);
        EXPECT_GE(w, 0);
        EXPECT_EQ(sign, 1);
        sum += w;
        for (int a = 0; a < D; ++a) {
          mean[a] += w * at[a];
          gradient_sum[a] += g[a];
          for (int b = 0; b < D; ++b) slope[a][b] += g[a] * at[b];
        }
      });
      EXPECT_NEAR(sum, 1, 1e-14);
      for (int a = 0; a < D; ++a) {
        EXPECT_NEAR(mean[a], x[a], 1e-13);
        EXPECT_NEAR(gradient_sum[a], 0, 1e-12);
        for (int b = 0; b < D; ++b) EXPECT_NEAR(slope[a][b], a == b, 1e-12);  // linear fields exactly
      }
    }
    double sum = 0;
    Vec<D> mean{};
    for_centers(grid, open, kernel, [&](int cell, double w) {
      sum += w;
      for (int a = 0; a < D; ++a) mean[a] += w * grid.center(grid.cell(cell))[a];
    });
    EXPECT_NEAR(sum, 1, 1e-14);
    for (int a = 0; a < D; ++a) EXPECT_NEAR(mean[a], x[a], 1e-13);
  });
}

TEST(Stencil, WeightsSumToOneWithTheirMeanAtThePoint) {
  expect_moments<2, QuadraticSpline>();
  expect_moments<3, QuadraticSpline>();
  expect_moments<2, LinearHat>();
  expect_moments<3, LinearHat>();
}

/// What carries water has the divergence of the cells around: within a cell of hats everywhere the cell's
/// own.
TEST(Stencil, MoversKeepTheCellsDivergence) {
  const Grid<2> grid = some_grid<2>();
  const Walls<2> open(grid);
  const auto flow = [](int d, int face) { return std::sin(1.7 * face + d); };
  const auto of_cell = [&](int i) {
    double sum = 0;
    for (int d = 0; d < 2; ++d) sum += (flow(d, i + grid.stride[d]) - flow(d, i)) / grid.h;
    return sum;
  };
  const auto at = [&](auto shape, const Vec<2>& x) {
    double sum = 0;
    for (int d = 0; d < 2; ++d)
      for_faces(grid, open, PointKernel<2, decltype(shape)>(grid, x), d,
                [&](int face, double, double, const Vec<2>& g) { sum += g[d] * flow(d, face); });
    return sum;
  };
  at_random_places(grid, 100, [&](const Vec<2>& x) {
    EXPECT_NEAR(at(HatMover{}, x), of_cell(grid.index(grid.cell_of(x))), 1e-11);
    double around = 0;  // hats between the cells' centres
    for_centers(grid, open, PointKernel<2, LinearHat>(grid, x),
                [&](int cell, double w) { around += w * of_cell(cell); });
    EXPECT_NEAR(at(SplineMover{}, x), around, 1e-11);
  });
}

/// Arms lead from the point to the faces, and the affine weights find the slope of a linear field.
template <int D, class Shape>
void expect_affine() {
  const Grid<D> grid = some_grid<D>();
  const Walls<D> open(grid);
  at_random_places(grid, 300, [&](const Vec<D>& x) {
    const PointKernel<D, Shape> kernel(grid, x);
    for (int d = 0; d < D; ++d) {
      std::array<Vec<D>, D> slope{};
      Vec<D> sum{};
      for_faces(grid, open, kernel, d, [&](int face, const FaceWeight<D>& f, double) {
        const Vec<D> at = face_place(grid, d, face), a = affine_weight<Shape>(f, grid.inverse_h);
        for (int i = 0; i < D; ++i) {
          EXPECT_NEAR(f.arm[i], at[i] - x[i], 1e-13);
          sum[i] += a[i];
          for (int j = 0; j < D; ++j) slope[i][j] += a[i] * at[j];
        }
      });
      for (int i = 0; i < D; ++i) {
        EXPECT_NEAR(sum[i], 0, 1e-12);  // no slope in a uniform field
        for (int j = 0; j < D; ++j) EXPECT_NEAR(slope[i][j], i == j, 1e-12);
      }
    }
  });
}

TEST(Stencil, AffineWeightsFindTheSlopeOfALinearField) {
  expect_affine<2, QuadraticSpline>();
  expect_affine<3, QuadraticSpline>();
  expect_affine<2, LinearHat>();
  expect_affine<3, LinearHat>();
}

/// What lane `k` of a window leaves on the faces of component d, with the derivatives along each axis.
template <int d, int D, class Shape>
std::map<int, std::array<double, D + 1>> on_faces(const CellWindow<D>& window,
                                                  const CellKernel<D, Shape>& kernel, double inverse_h,
                                                  int k) {
  std::map<int, std::array<double, D + 1>> left;
  window.faces(d, [&](int node, int face, double sign) {
    const int along[3] = {node % 4, node / 4 % 3, node / 12};
    auto& sum = left[face];
    for (int b = 0; b <= D; ++b) {
      double product = sign;
      for (int a = 0; a < D; ++a) {
        const int axis = axis_of(d, a);
        const auto pick = [&](const auto& nodes) {
          return axis == b ? nodes.dw[along[a]][k] * inverse_h : nodes.w[along[a]][k];
        };
        product *= a == 0 ? pick(kernel.face[axis]) : pick(kernel.center[axis]);
      }
      sum[b] += product;
    }
  });
  return left;
}

/// Kernels of eight points of a cell are those found one by one: anywhere in it, on its edges and beyond.
template <int D, class Shape>
void expect_lanes_agree(const Walls<D>& walls) {
  const Grid<D> grid = some_grid<D>();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> part(0, 1);
  // Slopes of hats jump there, and which side a point is on may differ by rounding.
  const double middle = std::is_same_v<Shape, QuadraticSpline> ? 0.5 : 0.5 + 1e-9;
  at_random_places(grid, 60, [&](const Vec<D>& somewhere) {
    const Cell<D> cell = grid.cell_of(somewhere);
    std::array<BatchLanes, D> x;
    std::array<Vec<D>, kBatch> places;
    for (int k = 0; k < kBatch; ++k)
      for (int d = 0; d < D; ++d) {
        const bool last = cell[d] == grid.cells[d] - 1;
        const double xi = k == 0 ? 1e-9 : k == 1 ? middle : k == 2 && last ? 1.3 : part(random);
        places[k][d] = grid.origin[d] + (cell[d] + xi) * grid.h;
      }
    for (int d = 0; d < D; ++d) x[d] = lanes_of<kBatch>([&](int k) { return places[k][d]; });
    CellKernel<D, Shape> kernel;
    std::array<BatchLanes, D> cells;
    for (int d = 0; d < D; ++d) cells[d] = all_lanes<BatchLanes>(cell[d]);
    kernel.find(grid, cells, x);
    const CellWindow<D> window(grid, walls, grid.index(cell));
    for (int k = 0; k < kBatch; ++k) {
      const PointKernel<D, Shape> alone(grid, places[k]);
      ASSERT_EQ(grid.index(cell), alone.home());
      for_components<D>([&](auto d) {
        auto left = on_faces<d, D>(window, kernel, grid.inverse_h, k);
        for_faces(grid, walls, alone, d, [&](int f, double w, double sign, const Vec<D>& g) {
          left[f][D] -= sign * w;
          for (int a = 0; a < D; ++a) left[f][a] -= sign * g[a];
        });
        for (const auto& [face, rest] : left)
          for (const double value : rest) EXPECT_NEAR(value, 0, 1e-13) << face;
      });
      std::map<int, double> centers;
      window.centers([&](int node, int cell_index) {
        double w = 1;
        for (int a = 0, rest = node; a < D; ++a, rest /= 3) w *= kernel.center[a].w[rest % 3][k];
        centers[cell_index] += w;
      });
      for_centers(grid, walls, alone, [&](int c, double w) { centers[c] -= w; });
      for (const auto& [c, rest] : centers) EXPECT_NEAR(rest, 0, 1e-14) << c;
    }
  });
}

template <int D, class Shape>
void expect_lanes_agree() {
  const Grid<D> grid = some_grid<D>();
  Walls<D> walls(grid);
  expect_lanes_agree<D, Shape>(walls);
  for (int d = 0; d < D; ++d)
    for_each_cell(grid, [&](int i, const Cell<D>& c) {
      if (c[d] == 0 || (c[d] == 3 && c[1 - d % 2] > 2)) walls.close(d, i, d == 0);
    });
  walls.rebuild(grid);
  expect_lanes_agree<D, Shape>(walls);
}

TEST(Stencil, KernelsInLanesAreThoseOfPointsAlone) {
  expect_lanes_agree<2, QuadraticSpline>();
  expect_lanes_agree<3, QuadraticSpline>();
  expect_lanes_agree<2, LinearHat>();
  expect_lanes_agree<2, SplineMover>();
  expect_lanes_agree<2, HatMover>();
}

/// A smooth function of the face's index, so that the interpolated field is not linear.
template <int D>
double field(const Grid<D>& grid, const Walls<D>& walls, const Vec<D>& x, int d, Vec<D>* gradient = nullptr) {
  double value = 0;
  const PointKernel<D> kernel(grid, x);
  for_faces(grid, walls, kernel, d, [&](int face, double w, double sign, const Vec<D>& g) {
    const double v = std::sin(1.7 * face);
    value += sign * w * v;
    if (gradient)
      for (int a = 0; a < D; ++a) (*gradient)[a] += sign * g[a] * v;
  });
  return value;
}

template <int D>
void expect_gradient_is_the_derivative(const Walls<D>& walls, const Grid<D>& grid) {
  constexpr double kStep = 1e-6;  // m; central differences of a quadratic are exact but for rounding
  int checked = 0;
  at_random_places(grid, 200, [&](const Vec<D>& x) {
    for (int a = 0; a < D; ++a) {  // not across a closed face, where the sign of the mirror may jump
      const double xi = (x[a] - grid.origin[a]) * grid.inverse_h;
      if (std::abs(xi - std::round(xi)) < 1e-3) return;
    }
    ++checked;
    for (int d = 0; d < D; ++d) {
      Vec<D> gradient{};
      field<D>(grid, walls, x, d, &gradient);
      for (int a = 0; a < D; ++a) {
        Vec<D> low = x, high = x;
        low[a] -= kStep, high[a] += kStep;
        const double slope = (field<D>(grid, walls, high, d) - field<D>(grid, walls, low, d)) / (2 * kStep);
        EXPECT_NEAR(gradient[a], slope, 2e-4);  // crossing a knot leaves O(step/h²)
      }
    }
  });
  EXPECT_GT(checked, 150);
}

TEST(Stencil, GradientIsTheDerivativeOfTheWeights2D) {
  const Grid<2> grid = some_grid<2>();
  expect_gradient_is_the_derivative(Walls<2>(grid), grid);
}
TEST(Stencil, GradientIsTheDerivativeOfTheWeights3D) {
  const Grid<3> grid = some_grid<3>();
  expect_gradient_is_the_derivative(Walls<3>(grid), grid);
}

TEST(Stencil, GradientIsTheDerivativeOfTheFoldedWeightsToo) {
  const Grid<2> grid = some_grid<2>();
  Walls<2> walls(grid);
  for (int y = 0; y < grid.cells[1]; ++y) walls.close(0, grid.index({3, y}), y % 2 == 0);
  for (int x = 0; x < grid.cells[0]; ++x) walls.close(1, grid.index({x, 0}), false);
  walls.rebuild(grid);
  expect_gradient_is_the_derivative(walls, grid);
}

TEST(Stencil, FieldIsContinuousBetweenCells) {
  const Grid<2> grid = some_grid<2>();
  const Walls<2> open(grid);
  constexpr double kGap = 1e-9;
  for (int d = 0; d < 2; ++d)
    for (int axis = 0; axis < 2; ++axis) {
      Vec<2> x = {grid.origin[0] + 0.47, grid.origin[1] + 0.71};
      for (const double knot : {0.4, 0.5}) {  // cell border, cell centre
        x[axis] = grid.origin[axis] + knot - kGap;
        const double before = field<2>(grid, open, x, d);
        x[axis] = grid.origin[axis] + knot + kGap;
        EXPECT_NEAR(field<2>(grid, open, x, d), before, 1e-6);
      }
    }
}

}  // namespace
}  // namespace quicksand

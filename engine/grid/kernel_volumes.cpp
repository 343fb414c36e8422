#include "engine/grid/kernel_volumes.hpp"

#include "engine/grid/stencil.hpp"

namespace quicksand {
namespace {

/// Adds the kernels of one place that stands for `volume`.
template <class Shape>
void add_place(const Grid<2>& grid, const Walls<2>& walls, const Vec<2>& x, double volume,
               KernelVolumes<2>& all) {
  const PointKernel<2, Shape> kernel(grid, x);
  for (int d = 0; d < 2; ++d)
    for_faces(grid, walls, kernel, d,
              [&](int face, double w, double, const Vec<2>&) { all.of_face[d][face] += w * volume; });
  for_centers(grid, walls, kernel, [&](int cell, double w) { all.of_cell[cell] += w * volume; });
}

/// Inside walls nothing is ever measured; a positive volume keeps divisions harmless.
void fill_empty(std::vector<double>& volumes, double value) {
  for (double& v : volumes)
    if (v <= 0) v = value;
}

template <class Shape>
KernelVolumes<2> about_axis(const Grid<2>& grid, const Walls<2>& walls, int points_per_cell) {
  KernelVolumes<2> all{grid.cell_volume(), {}, std::vector<double>(grid.count(), 0)};
  for (auto& of_face : all.of_face) of_face.assign(grid.count(), 0);
  const double spacing = grid.h / points_per_cell;
  for_each_cell(grid, [&](int i, const Cell<2>& c) {
    if (walls.blocked(i)) return;
    for (int k = 0; k < points_per_cell * points_per_cell; ++k) {
      const std::array<int, 2> place{k % points_per_cell, k / points_per_cell};
      Vec<2> x;
      for (int d = 0; d < 2; ++d) x[d] = grid.origin[d] + c[d] * grid.h + (place[d] + 0.5) * spacing;
      add_place<Shape>(grid, walls, x, spacing * spacing * grid.radius(x), all);
    }
  });
  for (auto& of_face : all.of_face) fill_empty(of_face, grid.cell_volume() * grid.h);
  fill_empty(all.of_cell, grid.cell_volume() * grid.h);
  return all;
}

}  // namespace

template <int D>
KernelVolumes<D> kernel_volumes(const Grid<D>& grid, const Walls<D>& walls, Kernel kernel,
                                int points_per_cell) {
  if constexpr (D == 2) {
    if (grid.axial)
      return with_kernel(
          kernel, [&](auto shape) { return about_axis<decltype(shape)>(grid, walls, points_per_cell); });
  }
  return {grid.cell_volume(), {}, {}};
}

template KernelVolumes<2> kernel_volumes<2>(const Grid<2>&, const Walls<2>&, Kernel, int);
template KernelVolumes<3> kernel_volumes<3>(const Grid<3>&, const Walls<3>&, Kernel, int);

}  // namespace quicksand

#pragma once
// How much each kernel of the lattice holds when everything is filled: what sums are divided by to make
// densities.

#include <vector>

#include "engine/grid/kernel.hpp"
#include "engine/grid/walls.hpp"

namespace quicksand {

/// m³ (per metre in the plane, per radian about an axis). In the plane and in space it is h^D everywhere and
/// nothing is stored. About an axis it is ∫ w r dA with what walls fold back, because a mirror image counts
/// with the radius of the point it belongs to; so a uniform filling reads as uniform beside the axis and
/// beside walls.
template <int D>
struct KernelVolumes {
  double uniform = 0;
  std::array<std::vector<double>, D> of_face;
  std::vector<double> of_cell;

  double face(int d, int i) const { return of_cell.empty() ? uniform : of_face[d][i]; }
  double cell(int i) const { return of_cell.empty() ? uniform : of_cell[i]; }
};

/// Measured with the seeding lattice of `points_per_cell` in all cells that are not blocked, so that seeded
/// ground is exactly uniform.
template <int D>
KernelVolumes<D> kernel_volumes(const Grid<D>& grid, const Walls<D>& walls, Kernel kernel,
                                int points_per_cell);

}  // namespace quicksand

#pragma once
// How points move: along their way, and never into a wall.

#include "engine/grid/walls.hpp"

namespace quicksand {

/// Distance from a wall at which a point that would enter it is put back, in cells.
inline constexpr double kClearance = 1e-6;

/// Moves x by u; a closed face on the way stops the component across it. Returns whether it did.
template <int D>
bool move_beside_walls(const Grid<D>& grid, const Walls<D>& walls, Vec<D>& x, const Vec<D>& u) {
  bool stopped = false;
  for (int d = 0; d < D; ++d) {
    const Cell<D> c = grid.cell_of(x);
    const double low = grid.origin[d] + c[d] * grid.h, high = low + grid.h;
    const int face = grid.index(c);
    x[d] += u[d];
    if (x[d] <= low && walls.closed(d, face)) {
      stopped = stopped || x[d] < low;
      x[d] = low + kClearance * grid.h;
    } else if (x[d] >= high && walls.closed(d, face + grid.stride[d])) {
      stopped = stopped || x[d] > high;
      x[d] = high - kClearance * grid.h;
    }
  }
  return stopped;
}
/// The same for x in the cell `home`.
template <int D>
inline bool move_point(const Grid<D>& grid, const Walls<D>& walls, int home, Vec<D>& x, const Vec<D>& u) {
  if (walls.folds(home)) return move_beside_walls<D>(grid, walls, x, u);
  for (int d = 0; d < D; ++d) x[d] += u[d];
  return false;
}

}  // namespace quicksand

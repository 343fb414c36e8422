// Gaps between the water's points that are no air. Points that move past a corner leave cells around it with
// less water than a wet one holds. Taken for air, such a cell would have no pressure amid water that has, and
// that would strike into it within a step: a blow that every probe shows.

#include <algorithm>
#include <mutex>
#include <vector>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// –, of a kernel's volume below the water surface. A cell that holds less is air.
constexpr double kLeastFill = 0.1;

/// Calls f(cell) for the neighbours of a cell behind its open sides; returns how many sides are closed.
template <int D, class F>
int for_neighbors(const State<D>& s, int cell, F&& f) {
  int closed = 0;
  for (int d = 0; d < D; ++d)
    for (int side : {0, 1}) {
      const int face = cell + side * s.grid.stride[d];
      if (s.water_walls.closed(d, face) || in_plate(s, d, face))
        ++closed;
      else
        f(cell + (2 * side - 1) * s.grid.stride[d]);
    }
  return closed;
}

/// A cell that is not wet but was, under more than the head of a cell, and is no air by itself or by one of
/// its neighbours. Where there was no pressure there is air: under a lid, or where water parts. In a shaft's
/// end, closed on all sides but one, there may be a bubble.
template <int D>
bool may_be_gap(const State<D>& s, int cell, double least_pressure) {
  if (s.pressure[cell] <= least_pressure || s.cell[cell].fill < kLeastFill) return false;
  bool beside_air = false;
  const int closed =
      for_neighbors(s, cell, [&](int other) { beside_air = beside_air || s.cell[other].fill < kLeastFill; });
  return !beside_air && closed <= D;
}

/// Whether the cells of `candidates` (sorted) that hang together with the first are few and closed in by
/// water.
template <int D>
bool is_gap(const State<D>& s, int first, const std::vector<int>& candidates) {
  constexpr std::size_t most = 2 * D;
  std::vector<int> gap{first};
  for (std::size_t k = 0; k < gap.size(); ++k) {
    bool enclosed = true;
    for_neighbors(s, gap[k], [&](int other) {
      if (s.cell[other].wet() || std::find(gap.begin(), gap.end(), other) != gap.end()) return;
      enclosed = enclosed && std::binary_search(candidates.begin(), candidates.end(), other);
      gap.push_back(other);
    });
    if (!enclosed || gap.size() > most) return false;
  }
  return true;
}

}  // namespace

template <int D>
void close_gaps(State<D>& s) {
  const double wave = cell_wave(s), head_of_cell = s.constants.water_density * wave * wave;
  std::vector<int> candidates;
  std::mutex adding;
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
      if (s.cell[i].wet() || !may_be_gap(s, i, head_of_cell)) return;
      const std::lock_guard lock(adding);
      candidates.push_back(i);
    });
  });
  std::sort(candidates.begin(), candidates.end());
  std::vector<int> gaps;
  for (const int cell : candidates)
    if (is_gap(s, cell, candidates)) gaps.push_back(cell);
  for (const int cell : gaps) s.cell[cell].row = 1;
}

template void close_gaps<2>(State<2>&);
template void close_gaps<3>(State<3>&);

}  // namespace quicksand

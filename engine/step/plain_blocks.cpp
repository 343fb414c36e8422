// Which blocks hold nothing but faces of the common kind.

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Cells of a block, and one more below it along every axis: all that its faces have to do with.
template <int D>
bool is_plain(const State<D>& s, int block) {
  const Cell<D> low = s.blocks.low(block);
  for (int d = 0; d < D; ++d)
    if (low[d] == 0 || low[d] + Blocks<D>::kEdge >= s.grid.cells[d]) return false;
  constexpr int edge = Blocks<D>::kEdge + 1;
  const int below = s.grid.index(low) - 1 - s.grid.stride[1] - (D == 3 ? s.grid.stride[D - 1] : 0);
  for (int z = 0; z < (D == 3 ? edge : 1); ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) {
        const int i = below + x + y * s.grid.stride[1] + (D == 3 ? z * s.grid.stride[D - 1] : 0);
        if (s.has_water && !(s.cell[i].confined && !s.water_walls.folds(i))) return false;
        if (s.soil_walls.folds(i)) return false;
      }
  return true;
}

}  // namespace

template <int D>
void find_plain_blocks(State<D>& s) {
  const bool moves_alone = s.has_water || !s.keeps_flow();  // or by plates, or damped
  if (s.grid.axial || s.keeps_rest() || !moves_alone) return;
  s.blocks.all([&](int b) { s.plain[b] = is_plain(s, b); });
}

template void find_plain_blocks<2>(State<2>&);
template void find_plain_blocks<3>(State<3>&);

}  // namespace quicksand

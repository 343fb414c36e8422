// Which blocks a step goes through, and what those hold that it no longer does.

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Faces and cells of a block become as those that nothing ever reached.
template <int D>
void forget(State<D>& s, int block) {
  const bool keeps_flow = s.keeps_flow();
  s.blocks.cells_at(s.grid, block, true, [&](int i, const Cell<D>&) {
    for (int d = 0; d < D; ++d) {
      s.sums[d].clear(i);
      s.image[d][i] = {};
      if (keeps_flow) s.flow[d][i] = {};
      s.speeds[d][i] = {};
      if (!s.soil_walls.port(d, i)) s.soil_walls.set_separated(d, i, false);
      s.soil_walls.commit_separated(d, i);
    }
    s.cell_sums[i] = {};
    if (!s.has_water) return;
    s.cell[i] = {};
    s.pressure[i] = s.pressure_old[i] = s.pressure_before[i] = 0;
  });
}

/// Markers of loads are among the points of their soil, but for those of a body that was removed.
template <int D>
std::vector<Vec<D>> marker_places(const State<D>& s) {
  std::vector<Vec<D>> x;
  for (const SurfaceLoad<D>& load : s.loads)
    for (const LoadMarker<D>& marker : load.markers) x.push_back(marker.x);
  return x;
}

}  // namespace

template <int D>
void activate_blocks(State<D>& s) {
  BlockList markers;
  s.blocks.locate(s.grid, s.soil.x, s.soil_blocks);
  s.blocks.locate(s.grid, s.water.x, s.water_blocks);
  s.blocks.locate(s.grid, marker_places(s), markers);
  for (const int block : s.blocks.activate({&s.soil_blocks, &s.water_blocks, &markers})) forget(s, block);
  s.plain.assign(s.blocks.count(), 0);
  s.blocks.group(s.soil_blocks);
  s.blocks.group(s.water_blocks);
}

template <int D>
void adopt_blocks(State<D>& s, std::vector<int> places) {
  for (const int block : s.blocks.active()) forget(s, block);
  s.blocks.adopt(std::move(places));
  s.plain.assign(s.blocks.count(), 0);
}

template void adopt_blocks<2>(State<2>&, std::vector<int>);
template void adopt_blocks<3>(State<3>&, std::vector<int>);
template void activate_blocks<2>(State<2>&);
template void activate_blocks<3>(State<3>&);

}  // namespace quicksand

#include "engine/run/snapshot.hpp"

#include "engine/run/setup.hpp"
#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

template <class A, class Set>
void keep_points(A& a, Set& set) {
  for_arrays(set, [&](auto& array) { a(array); });
  a(set.next_id);
}

template <class A, int D>
void keep_plate(A& a, Plate<D>& plate) {
  a(plate.start, plate.active, plate.sunk, plate.mass, plate.speed, plate.reaction, plate.touches);
  a(plate.folded, plate.mirrored, plate.slid, plate.row, plate.beside);
}

/// All that is not on the grid.
template <class A, int D>
void keep_bodies(A& a, State<D>& s) {
  Constants<D>& c = s.constants;
  a(s.time, s.steps, s.momentum, s.load_force, s.interventions, s.phase_seconds, s.removed);
  a(c.inertia, c.pic_rate, c.drift_time, c.damping);
  keep_points(a, s.soil), keep_points(a, s.fixed), keep_points(a, s.water);
  for (SurfaceLoad<D>& load : s.loads) a(load.markers, load.start, load.active);
  for (Plate<D>& plate : s.plates) keep_plate(a, plate);
  a(s.plates_left_rows, s.ports, s.reservoirs, s.straddlers);
}

/// Fields of the faces and cells of an active block. Those that a step fills before it reads them are left
/// out.
template <class A, int D>
void keep_block(A& a, State<D>& s, int block) {
  s.blocks.cells(s.grid, block, true, [&](int i, const Cell<D>&) {
    for (int d = 0; d < D; ++d) {
      a(s.speeds[d][i]);
      if (s.keeps_flow()) a(s.flow[d][i]);
      if (!s.follower[d].empty()) a(s.follower[d][i]);
      std::uint8_t lifted = s.soil_walls.separation(d, i);
      a(lifted);
      if constexpr (A::loading) s.soil_walls.set_separation(d, i, lifted);
    }
    if (s.counts_room) a(s.cell_sums[i]);
    if (s.has_water) a(s.cell[i], s.pressure[i], s.pressure_old[i]);
  });
}

/// Velocities behind plates.
template <class A, int D>
void keep_ghosts(A& a, State<D>& s) {
  for (std::size_t i = s.grid.count(); i < s.flow[kPlateAxis].size(); ++i)
    a(s.speeds[kPlateAxis][i], s.flow[kPlateAxis][i]);
}

template <class A, int D>
void keep_fields(A& a, State<D>& s) {
  for (int b = 0; b < s.blocks.count(); ++b) keep_block(a, s, b);
  keep_ghosts(a, s);
}

}  // namespace

template <int D>
void save_state(Saver& to, State<D>& s) {
  keep_bodies(to, s);
  std::vector<int> active = s.blocks.active();
  to(active);
  keep_fields(to, s);
}

template <int D>
void load_state(Loader& from, const Scene& scene, std::size_t stage, State<D>& s) {
  keep_bodies(from, s);
  set_walls(scene, scene.stages[stage], s);
  scale_limits(s);
  mark_again(s);
  std::vector<int> active;
  from(active);
  adopt_blocks(s, std::move(active));
  keep_fields(from, s);
  if (s.fixed.size()) measure_fixed(s);
}

template void save_state<2>(Saver&, State<2>&);
template void save_state<3>(Saver&, State<3>&);
template void load_state<2>(Loader&, const Scene&, std::size_t, State<2>&);
template void load_state<3>(Loader&, const Scene&, std::size_t, State<3>&);

}  // namespace quicksand

#pragma once
// The phases of one time step, in their order. Each reads what the ones before it wrote.

#include <cmath>

#include "engine/step/pressure.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

template <int D>
struct StepReport;

/// Places of the points → `blocks`, `soil_blocks`, `water_blocks`.
template <int D>
void activate_blocks(State<D>& s);
/// Makes the blocks at these places active and all fields empty.
template <int D>
void adopt_blocks(State<D>& s, std::vector<int> places);
/// Points → the same in the order of their cells, every so many steps.
template <int D>
void sort_points(State<D>& s);
/// Last velocities → `discharge` of the points that keep it, and what depends on it.
template <int D>
void follow_discharge(State<D>& s);
/// Points → `sums`, `cell_sums`.
template <int D>
void points_to_faces(State<D>& s);
/// Loads on the surfaces of bodies → `sums`, `load_force`.
template <int D>
void loads_to_faces(State<D>& s);
/// Markers of the loads move with the grains.
template <int D>
void move_loads(State<D>& s, double dt);
/// Linear kernel only: gives what acts on faces that hold next to nothing of a soil body to a neighbour that
/// does → `follower`, `sums`.
template <int D>
void join_light_faces(State<D>& s);
/// The velocities of such faces, once those of their leaders are known → `flow`.
template <int D>
void follow_leaders(State<D>& s);
/// The face that a face moves with in the end; itself if it moves on its own.
template <int D>
int leader_of(const State<D>& s, int d, int face);
/// What fixed grains occupy and resist → `fixed_face`, `fixed_cell`. Once per run, unless their drag follows
/// the water's speed.
template <int D>
void measure_fixed(State<D>& s);
/// Water surface, room and volume drift → `cell`; no pressure where no water is.
template <int D>
void find_surface(State<D>& s);
/// Makes cells wet that hold too little water for it amid others that hold enough.
template <int D>
void close_gaps(State<D>& s);
/// Blocks whose faces are worked out several at a time → `plain`.
template <int D>
void find_plain_blocks(State<D>& s);
/// Provisional velocities with drag inside, responses to a pressure gradient → `flow`.
template <int D>
void predict_velocities(State<D>& s, double dt);
/// Which faces plates hold, from where they are now → `plates`, `plate_of`, mirrors in `water_walls`, ghosts.
/// Between two steps only: a step folds and unfolds alike.
template <int D>
void mark_plates(State<D>& s);
/// The same for the rows that plates hold already.
template <int D>
void mark_again(State<D>& s);
/// What kernels leave beyond plates mirrored back → `sums`.
template <int D>
void fold_plates(State<D>& s);
/// Common velocities of what plates hold, and how these answer to the pressure → `plates`, `flow`.
template <int D>
void press_plates(State<D>& s, double dt);
/// Plates after the pressure is known → `plates`, `flow`.
template <int D>
void settle_plates(State<D>& s, double dt);
/// Plates move with their soil.
template <int D>
void move_plates(State<D>& s, double dt);
/// Velocities behind plates, for the points whose kernels reach there → `flow`.
template <int D>
void unfold_plates(State<D>& s);
/// Velocities after the pressure gradient; those of the water go on into the air → `speeds`, `flow`.
template <int D>
void correct_velocities(State<D>& s);
/// Whether the water's velocity at a face without pressure is asked for: hats reach faces at which their
/// weight is zero and its gradient is not.
template <int D>
inline bool may_be_extended(const State<D>& s, int d, int face) {
  return s.sums[d].water[face].mass > 0 || s.constants.kernel == Kernel::linear;
}
/// Velocities of the water at the faces next to its surface, extrapolated → `speeds`; in those active blocks,
/// by their numbers, that hold a face for it.
template <int D>
void extend_water(State<D>& s, const std::vector<std::uint8_t>& blocks);
/// Impulses (N·s) that supports give to the points in this step: walls and fixed grains, with the water's
/// pressure on them; the water surface to the drops that it carries; and damping. Summed from forces, not
/// from the change of momentum, so that the ledger's balance is a check.
template <int D>
struct Supports {
  Vec<D> walls{}, surface{}, damping{};
  double damped = 0;  ///< J, kinetic energy that the motion would have without damping, less what it has
};
template <int D>
Supports<D> support_impulses(const State<D>& s, double dt, double pic);
/// Faces → points: velocity, stress, porosity, position.
template <int D>
void faces_to_points(State<D>& s, double dt, StepReport<D>& report);

/// What the outside of every port is now: pressure, open or shut → `ports`, `water_walls`.
template <int D>
void set_ports(State<D>& s);
/// Points that passed a port in this step leave, and those that the flow brings in are made.
template <int D>
void pass_ports(State<D>& s, StepReport<D>& report);

/// Port of a face, or null.
template <int D>
const Port<D>* port_at(const State<D>& s, int d, int face) {
  if (s.ports.empty() || s.port_of[d][face] == 0) return nullptr;
  return &s.ports[s.port_of[d][face] - 1];
}
/// Whether a face has a reservoir's water on its other side.
template <int D>
bool submerged(const State<D>& s, int d, int face) {
  const Port<D>* port = port_at(s, d, face);
  return port && port->submerged();
}

/// Momentum, kinetic energy, mass and largest speeds of the points as they are → `report`.
template <int D>
void measure_motion(const State<D>& s, StepReport<D>& report);
/// Elastic energy of the moving grains, J.
template <int D>
double strain_energy(const State<D>& s);
inline constexpr int kPlateAxis = 1;  ///< plates are horizontal
/// Whether a face moves with a plate.
template <int D>
bool in_plate(const State<D>& s, int d, int face) {
  if (d != kPlateAxis || s.plate_of.empty() || s.plate_of[face] == 0) return false;
  return s.plates[s.plate_of[face] - 1].touches;
}
/// Whether the grains (and open water) of a face are pushed by the pressure: at wet faces, and at walls next
/// to water, where the gradient is that of still water.
template <int D>
bool feels_pressure(const State<D>& s, int d, int face) {
  return s.flow[d][face].wet || s.water_walls.closed(d, face);
}

/// Part of a kernel's volume that lies below the water surface, from the parts filled by water, grains and
/// bulk soil. Water fills the pores of the soil that is there first and free room after, so that a surface at
/// a soil's top, within it or above it is found.
inline double fill_of(double water, double grains, double soil_bulk) {
  if (soil_bulk <= 0) return water;
  const double n = 1 - grains / soil_bulk;
  return std::min(water / n, soil_bulk) + std::max(0.0, water - n * soil_bulk);
}

/// Pressure gradient across face `face` of component d as the velocities feel it, Pa/m: between two wet
/// cells (pressures `inner`), or from a wet cell to p = 0 at the water surface; at a closed face the weight
/// of still water.
template <int D>
double pressure_gradient(const State<D>& s, const Field<double>& inner, int d, int face);
template <int D>
double pressure_gradient(const State<D>& s, int d, int face) {
  return pressure_gradient(s, s.pressure, d, face);
}
/// The same as this step's velocities feel it: with the pressure explicit, that at the step's start where two
/// cells push on a face; at the surface always that at its end.
template <int D>
double felt_gradient(const State<D>& s, int d, int face) {
  return pressure_gradient(s, s.constants.explicit_pressure ? s.pressure_old : s.pressure, d, face);
}

/// The gradient that the grains of a face feel, Pa/m.
template <int D>
double gradient_on_grains(const State<D>& s, int d, int face) {
  const FaceFlow& f = s.flow[d][face];
  if (f.soaked_side)
    return s.rest[d][face].soaked * felt_gradient(s, d, face + f.soaked_side * s.grid.stride[d]);
  return feels_pressure(s, d, face) ? felt_gradient(s, d, face) : 0;
}

/// Acceleration of the water by its viscosity at a face that carries water, m/s².
template <int D>
double viscous_acceleration(const State<D>& s, int d, int face);

/// m/s, of a wave as long as a cell.
template <int D>
double cell_wave(const State<D>& s) {
  double g2 = 0;
  for (int d = 0; d < D; ++d) g2 += s.constants.fall(d) * s.constants.fall(d);
  return std::sqrt(std::sqrt(g2) * s.grid.h);
}

/// Least room for water, –: the smallest porosity a case may ask for. Below it grains have been pushed
/// into each other, and the flux of water through them would lose its meaning.
inline constexpr double kMinRoom = 0.02;
/// Largest porosity of a soil point: one grain alone in the water.
inline constexpr double kMaxPorosity = 0.999;
/// Faces with less than this part of a full face's mass carry no velocity of their own.
inline constexpr double kMassCutoff = 1e-10;
/// Smallest wet part of a face next to a wet cell; a flat surface gives more than 1/6.
inline constexpr double kLeastWetPart = 0.1;

/// Part of the way from a wet cell's centre to that of an air cell where p = 0.
inline double surface_distance(double depth_wet, double depth_air) {
  return std::max(kMinSurfaceDistance, depth_wet / (depth_wet - depth_air));
}

}  // namespace quicksand

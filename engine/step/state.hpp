#pragma once
// Everything a run holds between two steps, and the fields of the grid within one.
//
// Symbols (suffix _p point, _f face, _c cell): φ = 1−n grain fraction, n porosity, p water pressure (Pa,
// compression positive), vs vw velocities of grains and water, q = φ vs + n vw flux of the mixture,
// R drag (N·s/m⁴), h cell edge, V = h^D (about an axis times the radius).

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/grid/field.hpp"
#include "engine/grid/kernel_volumes.hpp"
#include "engine/grid/walls.hpp"
#include "engine/materials/stability.hpp"
#include "engine/points/blocks.hpp"
#include "engine/points/points.hpp"
#include "engine/step/face_sums.hpp"
#include "engine/step/multigrid.hpp"
#include "engine/step/pressure_system.hpp"

namespace quicksand {

/// Twice the mass that reached a face as a mirror image with its sign changed: what walls hold of its
/// momentum.
struct FaceImage {
  double soil = 0, water = 0;  ///< kg
};

/// A face that holds next to nothing of the grains, and accelerates with a neighbour that does.
struct Follower {
  int leader = 0;       ///< face, which may follow another itself; 0: the face moves on its own
  double mass = 0;      ///< kg, that its points left there, less mirror images
  double velocity = 0;  ///< m/s, their mean
};

/// What grains that never move occupy and resist; computed once.
struct FixedFace {
  double phi = 0, bulk = 0;  ///< –, grains; grains and pores
  double resistivity = 0;    ///< N·s/m⁴, ρw g/k over the part that is soil
};

/// Velocities of a face at the start and the end of the step, m/s: what points read, close together in
/// memory.
struct alignas(32) FaceSpeeds {
  double soil_old = 0, soil = 0, water_old = 0, water = 0;
};

/// What a face's velocities follow from: how they answer to a pressure gradient G, v = v̂ − response·G, and
/// what is between the phases. Kept only where State::keeps_flow. Of 64 bytes: most of a step's traffic on
/// faces is with these.
struct alignas(64) FaceFlow {
  double soil_response = 0, water_response = 0;  ///< m/s per Pa/m
  double phi = 0, n = 1;                         ///< –, moving grains; room for water
  /// N·s/m³, impulse of the drag on the grains in this step, and how it answers to G. Worked out with the
  /// velocities: from their difference, what a drag of 10¹⁵ N·s/m⁴ does could not be told.
  double exchange = 0, exchange_response = 0;
  double viscous = 0;           ///< N/kg, force of the viscosity on the water
  std::uint8_t wet = 0;         ///< 1: a side has pressure; 2, 3: extrapolated from such
  std::int8_t soaked_side = 0;  ///< ±1: the next face along the component that side soaks it, see FaceRest

  double flux(const FaceSpeeds& v) const { return phi * v.soil + n * v.water; }  ///< m/s
  double flux_response() const { return phi * soil_response + n * water_response; }
};

/// What only some scenes and some faces need beside FaceFlow, within a step. As it was, untouched in memory,
/// where neither fixed grains, damping nor FaceFlow::soaked_side ask for it.
struct FaceRest {
  double pushed = 0;  ///< –, of the grains, by what the gradient is beyond still water's; with fixed grains
  double fixed_drag = 0;                       ///< N·s/m⁴ on the water, of grains that do not move
  double soil_inertia = 1, water_inertia = 1;  ///< –, what damping multiplies inertia by in this step
  /// –, part of the soil of a face just above the water surface that lies below it, as far as kernels reach:
  /// it shares the pressure gradient of the face at the surface.
  double soaked = 0;
};

struct CellSums {
  double water = 0, grains = 0, soil_bulk = 0;  ///< m³, at the cell's centre
};

/// A cell has pressure where the water surface lies at least this far (cells) above its centre: one that just
/// touches the centre would make a stiff row and flicker by rounding. Below, the surface lies a little beyond
/// the next centre instead.
inline constexpr double kMinSurfaceDistance = 0.05;

struct CellState {
  double fill = 0;        ///< –, part of a kernel's volume below the water surface
  double depth = -1.5;    ///< cells from the water surface, positive in water, within ±1.5
  double excess = 0;      ///< –, volume of water and grains beyond the room, where fully wet
  double n = 1;           ///< –, room for water
  int row = 0;            ///< 1 + row in the pressure system; 0: air or wall
  bool confined = false;  ///< wet, and no air in the cells around
  bool wet() const { return row > 0; }
  /// Wet because water closes it in, not by what it holds (see close_gaps).
  bool is_gap() const { return wet() && depth <= kMinSurfaceDistance; }
};

/// Counters of everything that is done to the state other than by the equations.
struct Interventions {
  long clipped_points = 0;  ///< put back in front of a wall
  long clamped_values = 0;  ///< porosities held within bounds
  long cut_steps = 0;       ///< steps begun again with half the time
  long retries = 0;         ///< times that the run went back to its last good state
  Interventions& operator+=(const Interventions& o) {
    clipped_points += o.clipped_points;
    clamped_values += o.clamped_values;
    cut_steps += o.cut_steps;
    retries += o.retries;
    return *this;
  }
};

/// Constants of a run.
template <int D>
struct Constants {
  Vec<D> gravity{};  ///< m/s²
  /// –, ≥ 1: what inertia, never weight, is multiplied by (plan/quasi_static.hpp). Points keep their true
  /// masses; momenta, kinetic energy and the masses that forces accelerate are `inertia` times as large.
  double inertia = 1;
  double fall(int d) const { return gravity[d] / inertia; }  ///< m/s², by weight alone
  double water_density = 1000;                               ///< kg/m³
  double water_compliance = 0;                               ///< 1/Pa, 1/Kw; 0: incompressible
  double viscosity = 0;                                      ///< Pa·s
  double pic_rate = 0;                                       ///< 1/s
  double pressure_tolerance = 1e-6;
  double drift_time = 0;  ///< s; 0: no feedback
  double damping = 0;     ///< –, of the stage; engine/step/damping.hpp
  Kernel kernel = Kernel::quadratic;
  Transfer transfer = Transfer::flip;
  bool explicit_pressure = false;  ///< pressure advanced from the last one instead of solved for
  int points_per_cell = 2;         ///< per axis, of points that enter
  std::vector<SoilMaterial> soils;
  std::vector<StepLimit> step_limits;  ///< per soil
  /// Whether porosity alone tells a point's step.
  bool one_stiffness() const { return soils.size() == 1 && !soils.front().varies_stiffness(); }
};

/// Carries its part of a surface load in the layer of soil below the surface; moves with the grains.
template <int D>
struct LoadMarker {
  Vec<D> x{};         ///< m
  Vec<D> normal{};    ///< –, F N: the outward direction at the start, stretched and turned with the soil
  double area = 0;    ///< m², ∂χ/∂N dV0; about an axis times the surface's radius; sums to the surface
  double volume = 0;  ///< m³, χ dV0
};

/// A load on one side of a soil body; engine/step/loads.cpp.
template <int D>
struct SurfaceLoad {
  std::vector<LoadMarker<D>> markers;
  Vec<D> traction{};           ///< Pa at full load
  double start = 0, ramp = 0;  ///< s
  bool active = false;
};

/// A rigid, massless, horizontal plate on soil; engine/step/plates.cpp. It moves grains and water of a row of
/// faces as one.
template <int D>
struct Plate {
  Vec<D> low{}, high{};        ///< m, its extent at the start; `low` and `high` agree in y
  bool rough = false;          ///< grains at it do not slide
  bool driven = false;         ///< moved at `velocity`; otherwise pushed by `force`
  Vec<D> velocity{};           ///< m/s at full load
  double force = 0;            ///< N, upward, at full load
  double start = 0, ramp = 0;  ///< s
  bool active = false;

  double sunk = 0;                          ///< m, how far it has moved up (negative: down)
  double mass = 0;                          ///< kg, of all that moves with it in this step
  double speed = 0;                         ///< m/s, upward
  double reaction = 0;                      ///< N, upward, from the plate on soil and water in the last step
  bool touches = true;                      ///< false while it is lifted off the soil
  bool folded = false;                      ///< kernels were mirrored at it in this step
  double mirrored = 0;                      ///< kg, that mirror images add to what moves with it
  Vec<D> slid{};                            ///< kg·m/s, what its sliding gave to mirror images
  std::vector<int> row;                     ///< faces of component y in its plane
  std::vector<std::pair<int, int>> beside;  ///< (other component, face) just below the plane

  /// Part of the load or speed that acts at time t.
  double rise(double t) const { return ramp > 0 ? std::clamp((t - start) / ramp, 0.0, 1.0) : 1; }
};

/// A face of the boundary through which water enters and leaves; engine/step/ports.cpp.
template <int D>
struct Port {
  int d = 0, face = 0;
  int inward = 1;        ///< +1 or −1 along d
  int reservoir = -1;    ///< index; −1: an open side, which grains leave through too
  double elevation = 0;  ///< m, of the face's middle against gravity
  double pressure = 0;   ///< Pa, at the face from outside; 0 above the reservoir's level
  bool below_level = false;
  bool open = true;  ///< seepage faces shut while water would enter
  double owed = 0;   ///< m³, volume that flowed in and that points have not carried in yet
  bool submerged() const { return below_level; }
};

/// Level of a reservoir and what has come in from it.
struct ReservoirState {
  double from = 0, to = 0, start = 0, ramp = 0;  ///< m, m, s, s
  double mass_in = 0;                            ///< kg, net
  double inflow = 0;                             ///< m³/s, in the last step
  double level(double t) const {
    return ramp > 0 ? from + (to - from) * std::clamp((t - start) / ramp, 0.0, 1.0) : to;
  }
};

/// A water point that is partly outside: its share of the lattice, one spacing wide, reaches over a port.
struct Straddler {
  std::uint32_t point = 0;
  int port = 0;
  double depth = 0;      ///< spacings, of the middle of the whole share behind the port; −½ … ½
  double full_mass = 0;  ///< kg, when it is inside
};

/// What entered and left through ports.
template <int D>
struct Exchange {
  double water_in = 0, water_out = 0, soil_out = 0;  ///< kg
  Vec<D> momentum{};                                 ///< N·s, of what came in less what left
};

/// Parts of a step whose wall time is kept.
enum class Phase { to_grid, surface, velocities, pressure, to_points };
inline constexpr std::array<const char*, 5> kPhaseNames{"to grid", "surface", "velocities", "pressure",
                                                        "to points"};

template <int D>
struct State {
  Grid<D> grid;
  Blocks<D> blocks;
  Walls<D> water_walls;  ///< what water and its pressure cannot pass
  Walls<D> soil_walls;   ///< the same and the surfaces of fixed soil
  Constants<D> constants;

  bool has_water = false;  ///< there is water, or it can come in; else all that is about water stays zero
  bool has_soil = false;   ///< there are grains, moving or fixed
  /// Grains alone need only their velocities, unless damping or plates ask for more.
  bool keeps_flow() const { return has_water || constants.damping > 0 || !plates.empty(); }
  /// Whether `rest` is kept for every face.
  bool keeps_rest() const { return fixed.size() > 0 || constants.damping > 0; }
  bool counts_room = true;  ///< what soil takes of cells is asked for: by water, plates or samples
  SoilPoints<D> soil;       ///< moving grains
  SoilPoints<D> fixed;      ///< grains held in place
  WaterPoints<D> water;
  std::vector<char> removed;  ///< per body, whether a stage took it away; empty while none did
  BlockList soil_blocks, water_blocks;
  /// Per active block, 1 if no wall, plate or port is among what its faces have to do with, and all of that
  /// is wet if there is water at all; engine/step/plain_faces.hpp. 0 until they are looked for.
  std::vector<std::uint8_t> plain;
  KernelVolumes<D> volume;
  std::vector<SurfaceLoad<D>> loads;
  std::vector<Plate<D>> plates;
  /// Per face of component y, 1 + index of the plate in whose row it lies, or 0. Empty without plates.
  std::vector<std::int32_t> plate_of;
  bool plates_left_rows = false;  ///< some plate has come to another row: to be marked before the next step
  std::vector<Port<D>> ports;
  std::vector<ReservoirState> reservoirs;
  std::vector<Straddler> straddlers;
  std::vector<int> port_blocks;  ///< places of the blocks from which a point can reach a port in one step
  /// Per face, 1 + index into ports, or 0. Empty without ports.
  std::array<Field<std::int32_t>, D> port_of;

  // On the whole lattice, but only what lies in active blocks is ever other than zeros.
  // Behind the faces of component y, sums, image, flow and speeds hold the ghosts of `water_walls`.
  std::array<FaceSumFields, D> sums;
  std::array<Field<FaceImage>, D> image;
  std::array<Field<Follower>, D> follower;  ///< linear kernel only
  std::array<Field<FaceSpeeds>, D> speeds;
  std::array<Field<FaceFlow>, D> flow;
  std::array<Field<FaceRest>, D> rest;
  /// FaceFlow::flux as predicted, m/s, and flux_response, of wet faces: what the pressure system is made of,
  /// close together in memory.
  std::array<Field<double>, D> flux, flux_response;
  std::array<Field<FixedFace>, D> fixed_face;
  Field<CellSums> cell_sums;
  Field<CellSums> fixed_cell;
  Field<CellState> cell;
  Field<double> pressure;         ///< Pa per cell; 0 in air
  Field<double> pressure_old;     ///< Pa, at the start of the step
  Field<double> pressure_before;  ///< Pa, at the start of the step before; 0 where there was none
  PressureSystem<D> pressure_system;
  Multigrid<D> multigrid;  ///< of the pressure system

  double time = 0;      ///< s
  long steps = 0;       ///< that were begun
  Vec<D> momentum{};    ///< N·s, Σ m v of all moving points, × inertia
  Vec<D> load_force{};  ///< N, of the surface loads in this step
  Interventions interventions;
  std::array<double, kPhaseNames.size()> phase_seconds{};  ///< wall time
};

}  // namespace quicksand

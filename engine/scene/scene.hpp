#pragma once
// What the user asked for: plain values with their defaults. SI units throughout; stress is tension
// positive, water pressure compression positive. The key names of a case file are the names used here.
// A plane-strain scene ignores the third component of every Vec3.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quicksand {

using Vec3 = std::array<double, 3>;

enum class Dimension { plane_strain, axisymmetric, space };

/// What happens to soil and water at one side of the domain. slip and no_slip are walls that grains may
/// leave; symmetry holds the normal velocity both ways; open lets both phases out.
enum class SideKind { slip, no_slip, symmetry, open };
struct Side {
  SideKind kind = SideKind::slip;
};

struct Domain {
  Dimension dimension = Dimension::plane_strain;
  Vec3 min{0, 0, 0};            ///< m
  Vec3 max{1, 1, 1};            ///< m
  double cell_size = 0;         ///< m, at `numerics.cell_size_factor` 1 (the standard preset)
  std::array<Side, 6> sides{};  ///< left right bottom top front back (−x +x −y +y −z +z)
};

/// power: k = value · [(1+e)/(1+e0)]^exponent with the void ratio e = n/(1−n).
enum class PermeabilityLaw { constant, kozeny_carman, power, ergun };
struct Permeability {
  PermeabilityLaw law = PermeabilityLaw::kozeny_carman;
  double value = 0;       ///< m/s, hydraulic conductivity at the initial porosity
  double exponent = 2;    ///< –, power only
  double grain_size = 0;  ///< m, ergun only
};

enum class SoilLaw { linear_elastic, mohr_coulomb, modified_cam_clay };
struct SoilModel {
  SoilLaw law = SoilLaw::linear_elastic;
  double young_modulus = 0;                   ///< Pa
  double poisson_ratio = 0;                   ///< –
  double friction_angle = 0;                  ///< degrees
  double dilation_angle = 0;                  ///< degrees
  double cohesion = 0;                        ///< Pa
  std::optional<double> tension_cutoff{};     ///< Pa, largest tension; absent: the cone's apex
  std::optional<double> residual_cohesion{};  ///< Pa, after softening; absent: cohesion stays
  double softening_strain = 0;  ///< –, plastic shear strain over which cohesion falls to residual
  // modified_cam_clay: poisson_ratio and these.
  double compression_slope = 0;         ///< –, λ, of e over ln p′ in virgin compression
  double swelling_slope = 0;            ///< –, κ, of e over ln p′ in unloading
  double critical_state_slope = 0;      ///< –, M, of q over p′ at critical state
  double over_consolidation_ratio = 1;  ///< –, preconsolidation over the yield pressure of the initial stress
};

struct Soil {
  double grain_density = 2650;         ///< kg/m³
  double porosity = 0.4;               ///< –, initial
  std::optional<double> max_porosity;  ///< –, grains lose contact above it
  Permeability permeability;
  SoilModel model;
  std::optional<double>
      k0;  ///< –, horizontal over vertical effective stress at the start; wins over Initial::k0
};

struct Water {
  double density = 1000;                       ///< kg/m³
  std::optional<double> bulk_modulus = 2.2e9;  ///< Pa; absent: incompressible
  double viscosity = 1e-3;                     ///< Pa·s
};

/// A set of places, in metres. `polygon` and `disc` are extruded along z in space.
struct Region {
  enum class Kind { box, polygon, disc, union_of, difference } kind = Kind::box;
  Vec3 min{}, max{};                            ///< box
  std::vector<std::array<double, 2>> vertices;  ///< polygon, either orientation
  Vec3 center{};                                ///< disc
  double radius = 0;                            ///< disc
  std::vector<Region> parts;                    ///< union_of: all; difference: the first less all others
};

enum class BodyKind { soil, saturated_soil, water };
struct Body {
  std::string name;
  BodyKind kind = BodyKind::water;
  std::string soil;  ///< key into Scene::soils; not for water
  Region region;
  bool fixed = false;        ///< grains are held in place and cannot be entered by other grains
  Vec3 velocity{};           ///< m/s, initial
  double rotation_rate = 0;  ///< rad/s, initial, from x to y about the middle of the region's bounding box
};

struct Segment {
  Vec3 from{}, to{};  ///< m; along a grid axis, on cell faces
};

/// A solid block or a wall of no thickness on cell faces.
struct Wall {
  std::string name;
  std::optional<Region> block;  ///< box
  std::optional<Segment> line;
  bool no_slip = false;
};

/// A thin wall that stages can open. Closed unless a stage opens it.
struct Gate {
  std::string name;
  Segment line;
};

/// A stretch of the domain's boundary that is connected to water of given level: water enters and leaves,
/// grains stay. Above the level it is a seepage face, where water only leaves.
struct Reservoir {
  std::string name;
  Segment line;     ///< in space: a rectangle by two opposite corners
  double head = 0;  ///< m, elevation of the level
};

enum class InitialPressure { hydrostatic, zero, uniform };
enum class InitialStress { zero, k0, uniform };
struct Initial {
  InitialPressure pressure = InitialPressure::hydrostatic;
  std::optional<double> water_table;  ///< m; absent: each connected water's own surface
  double uniform_pressure = 0;        ///< Pa, excess over zero everywhere
  InitialStress stress = InitialStress::k0;
  std::optional<double> k0;  ///< –; absent: 1 − sin φ (Jaky), or ν/(1−ν) for elastic soil
  std::array<double, 6> uniform_stress{};  ///< Pa, xx yy zz xy yz zx, effective
};

/// Side of a body, in the order of Domain::sides.
enum class BodySide { left, right, bottom, top, front, back };

/// Pressure-like load on one side of a body, or a rigid plate on its top that water does not pass.
struct Load {
  enum class Kind { traction, plate } kind = Kind::traction;
  std::string name;
  std::string body;
  BodySide side = BodySide::top;    ///< that the traction acts on
  Vec3 traction{};                  ///< Pa, per area of the side at the start
  double ramp = 0;                  ///< s, linear rise from the start of the stage that sets it
  Vec3 plate_velocity{};            ///< m/s
  std::optional<Vec3> plate_force;  ///< N (per metre in the plane, per radian about an axis)
  Segment plate;                    ///< on cell faces at the start; in space a rectangle
  bool rough = false;               ///< the soil does not slide along it
};

struct UntilRest {
  double speed = 1e-4;  ///< m/s, largest speed of any point
  double at_least = 0;  ///< s
};

struct Stage {
  std::string name;
  double duration = 0;  ///< s; with until_rest: at most
  std::optional<UntilRest> until_rest;
  std::vector<std::string> open_gates;            ///< all others are closed
  std::map<std::string, double> heads;            ///< reservoir → m, kept in later stages
  double heads_ramp = 0;                          ///< s, over which heads go linearly to their new values
  std::optional<std::vector<std::string>> loads;  ///< acting in this stage; absent: all
  std::vector<std::string> remove_bodies;
  double damping = 0;         ///< –, fraction of the out-of-balance force (local damping)
  bool quasi_static = false;  ///< scale inertia, never weight, so that slow processes take few steps
};

struct Probe {
  std::string name;
  Vec3 at{};
  std::string quantity;  ///< pore_pressure | head | water_velocity | soil_velocity | porosity
};
struct Section {
  std::string name;
  Segment line;
  std::string quantity;  ///< flow
};
/// Asks for the headline figures of a heave: when the body moved and the gradient then.
struct HeaveWatch {
  std::string body;
  double threshold = 5e-4;   ///< m, mean upward movement that counts as heave
  std::string below, above;  ///< head probes at the body's lower and upper face
};
struct Output {
  double frame_interval = 0.1;      ///< s
  double series_interval = 0.01;    ///< s
  std::vector<std::string> fields;  ///< empty: all
  std::vector<Probe> probes;
  std::vector<Section> sections;
  std::optional<HeaveWatch> heave;
};

enum class Preset { draft, standard, fine };
enum class Kernel { quadratic, linear };
enum class Transfer { flip, apic };
enum class PressureScheme { implicit, explicit_scheme };
/// Companion runs on other cells that tell the discretisation error with the answer.
enum class ErrorEstimate { none, coarser, finer };
struct Numerics {
  Preset preset = Preset::standard;
  double cell_size_factor = 1;  ///< –, multiplies domain.cell_size (draft 2, fine ½)
  int points_per_cell = 2;      ///< per axis
  Kernel kernel = Kernel::quadratic;
  Transfer transfer = Transfer::flip;
  double pic_rate = 5;  ///< 1/s, rate at which a point's velocity relaxes to the grid's
  PressureScheme pressure = PressureScheme::implicit;
  double pressure_tolerance = 1e-6;  ///< –, see engine/step/pressure.hpp
  std::optional<double> time_step;   ///< s; absent: chosen each step
  double time_step_factor = 0.8;     ///< –, of the stability bound
  double drift_time = 0.05;          ///< s, over which true volume drift is fed back; 0: never
  /// –, how often a wave crosses the soil within the process's own time in a quasi-static stage.
  double quasi_static_transits = 200;
  long max_steps = 100'000'000;
  ErrorEstimate error_estimate = ErrorEstimate::none;  ///< finer: a coarser and a finer companion
  std::optional<double> target_error;                  ///< –, of a figure's range: choose the cells for it
  std::optional<double> budget_seconds;                ///< s on one core: likewise
  std::string chosen;  ///< why these cells, once they are chosen (settings_choice.hpp)
};

struct Scene {
  std::string name, description;
  Domain domain;
  Vec3 gravity{0, -9.81, 0};  ///< m/s²
  std::map<std::string, Soil> soils;
  Water water;
  std::vector<Body> bodies;
  std::vector<Wall> walls;
  std::vector<Gate> gates;
  std::vector<Reservoir> reservoirs;
  Initial initial;
  std::vector<Load> loads;
  std::vector<Stage> stages;
  Output output;
  Numerics numerics;

  /// Edge of a cell in metres after the preset's factor.
  double cell_size() const { return domain.cell_size * numerics.cell_size_factor; }
};

/// Something wrong in what the user asked for. `pointer` is the JSON pointer of the place in the case.
struct Fault {
  std::string pointer;
  std::string detail;  ///< value, allowed range, what to do
};

}  // namespace quicksand

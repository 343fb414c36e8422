#include "engine/run/setup.hpp"

#include <cmath>
#include <set>

#include "engine/grid/scene_grid.hpp"
#include "engine/plan/soil_stiffness.hpp"
#include "engine/points/seeding.hpp"
#include "engine/run/initial_state.hpp"
#include "engine/run/surface_load.hpp"
#include "engine/scene/stages.hpp"
#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

template <int D>
Constants<D> make_constants(const Scene& scene, const Grid<D>& grid) {
  Constants<D> c;
  for (int d = 0; d < D; ++d) c.gravity[d] = scene.gravity[d];
  c.water_density = scene.water.density;
  c.water_compliance = scene.water.bulk_modulus ? 1 / *scene.water.bulk_modulus : 0;
  c.viscosity = scene.water.viscosity;
  c.pic_rate = scene.numerics.pic_rate;
  c.pressure_tolerance = scene.numerics.pressure_tolerance;
  c.drift_time = scene.numerics.drift_time;
  c.kernel = scene.numerics.kernel;
  c.transfer = scene.numerics.transfer;
  c.explicit_pressure = scene.numerics.pressure == PressureScheme::explicit_scheme;
  c.points_per_cell = scene.numerics.points_per_cell;
  for (const auto& [name, soil] : scene.soils) {
    c.soils.push_back(SoilMaterial::from(soil, scene.water, usual_stress(scene, soil)));
    c.step_limits.emplace_back(c.soils.back(), c.water_density, c.water_compliance,
                               bounding_edge(c.kernel, grid.h, c.points_per_cell));
  }
  return c;
}

template <int D>
Plate<D> make_plate(const Load& load) {
  Plate<D> plate;
  for (int d = 0; d < D; ++d) {
    plate.low[d] = std::min(load.plate.from[d], load.plate.to[d]);
    plate.high[d] = std::max(load.plate.from[d], load.plate.to[d]);
    plate.velocity[d] = load.plate_velocity[d];
  }
  plate.rough = load.rough;
  plate.driven = !load.plate_force;
  if (load.plate_force) plate.force = (*load.plate_force)[kPlateAxis];
  plate.ramp = load.ramp;
  return plate;
}

template <int D>
void make_ports(const std::vector<PortFace>& faces, State<D>& s) {
  if (faces.empty()) return;
  for (auto& of_face : s.port_of) of_face = Field<std::int32_t>(s.grid.count());
  double g2 = 0;
  for (double c : s.constants.gravity) g2 += c * c;
  std::set<int> near;
  for (const PortFace& f : faces) {
    Port<D> port{.d = f.d, .face = f.face, .inward = f.inward, .reservoir = f.reservoir};
    const Cell<D> cell = s.grid.cell(f.inward > 0 ? f.face : f.face - s.grid.stride[f.d]);
    Vec<D> middle = s.grid.center(cell);
    middle[f.d] -= 0.5 * f.inward * s.grid.h;
    if (g2 > 0)
      for (int d = 0; d < D; ++d) port.elevation -= s.constants.gravity[d] / std::sqrt(g2) * middle[d];
    s.ports.push_back(port);
    s.port_of[f.d][f.face] = static_cast<std::int32_t>(s.ports.size());
    for (int k = 0; k < power(3, D); ++k) {
      Cell<D> c = cell;
      for (int d = 0, rest = k; d < D; ++d, rest /= 3)
        c[d] = std::clamp(c[d] + rest % 3 - 1, 0, s.grid.cells[d] - 1);
      near.insert(s.blocks.block_of(c));
    }
  }
  s.port_blocks.assign(near.begin(), near.end());
  for (const int block : near) s.blocks.pin(block);
}

/// Levels that reservoirs go to in a stage; those it does not name stay where they are.
template <int D>
void set_levels(const Scene& scene, const Stage& stage, State<D>& s) {
  if (s.reservoirs.empty())
    for (const Reservoir& r : scene.reservoirs) s.reservoirs.push_back({.from = r.head, .to = r.head});
  for (std::size_t r = 0; r < scene.reservoirs.size(); ++r) {
    const auto head = stage.heads.find(scene.reservoirs[r].name);
    if (head == stage.heads.end()) continue;
    ReservoirState& now = s.reservoirs[r];
    now.from = now.level(s.time);
    now.to = head->second;
    now.start = s.time;
    now.ramp = stage.heads_ramp;
  }
}

/// Loads that a stage names act on bodies that are still there.
template <int D>
void switch_loads(const Scene& scene, const Stage& stage, State<D>& s) {
  const auto gone = [&](const std::string& body) {
    for (std::size_t b = 0; b < s.removed.size(); ++b)
      if (s.removed[b] && scene.bodies[b].name == body) return true;
    return false;
  };
  std::size_t traction = 0, plate = 0;
  for (const Load& load : scene.loads) {
    const bool removed = gone(load.body);
    const bool named =
        !stage.loads || std::find(stage.loads->begin(), stage.loads->end(), load.name) != stage.loads->end();
    const auto set = [&](auto& state) {
      const bool acts = named && !removed;
      if (acts && !state.active) state.start = s.time;
      state.active = acts;
    };
    if (load.kind == Load::Kind::traction) {
      SurfaceLoad<D>& surface = s.loads[traction++];
      set(surface);
      if (removed) surface.markers.clear();
    } else {
      Plate<D>& rigid = s.plates[plate++];
      set(rigid);
      if (!rigid.active) rigid.reaction = rigid.speed = 0;
    }
  }
}

/// Room for the speeds that the drag of some soil of the set asks for.
template <int D>
void keep_discharge(const State<D>& s, SoilPoints<D>& set) {
  if (std::any_of(set.soil.begin(), set.soil.end(),
                  [&](int k) { return s.constants.soils[k].drag.follows_speed(); }))
    set.discharge.assign(set.size(), 0);
}

/// For the affine transfer, the gradient of the points' initial velocity.
template <class Set>
void carry_gradient(const Scene& scene, Set& set) {
  set.carries_gradient = true;
  set.affine.assign(set.size(), {});
  for (std::size_t p = 0; p < set.size(); ++p) {
    const double rate = scene.bodies[set.body[p]].rotation_rate;
    set.affine[p][0][1] = -rate, set.affine[p][1][0] = rate;
  }
}

/// Part of the domain from which on its fields take large pages.
constexpr double kFull = 0.5;

template <int D>
void wish_large_pages_if_full(State<D>& s) {
  activate_blocks(s);
  const double active = static_cast<double>(s.blocks.count()) * Blocks<D>::kCells;
  if (active < kFull * static_cast<double>(s.grid.count())) return;
  for (int d = 0; d < D; ++d)
    s.sums[d].each([](auto& field) { wish_large_pages(field); }), wish_large_pages(s.flow[d]),
        wish_large_pages(s.speeds[d]), wish_large_pages(s.flux[d]), wish_large_pages(s.flux_response[d]);
  wish_large_pages(s.cell_sums), wish_large_pages(s.cell);
}

}  // namespace

template <int D>
State<D> make_state(const Scene& scene) {
  State<D> s;
  s.grid = make_grid<D>(scene);
  s.blocks = Blocks<D>(s.grid);
  s.constants = make_constants<D>(scene, s.grid);
  SeededPoints<D> points = seed<D>(scene, s.grid);
  s.soil = std::move(points.soil);
  s.fixed = std::move(points.fixed);
  s.water = std::move(points.water);
  s.has_water = has_water(scene);
  s.has_soil = s.soil.size() + s.fixed.size() > 0;
  s.counts_room = s.has_water || !scene.output.probes.empty() || !scene.loads.empty();
  keep_discharge(s, s.soil), keep_discharge(s, s.fixed);
  for (int d = 0; d < D; ++d) {
    s.sums[d] = FaceSumFields(s.grid.count(), s.has_soil, s.has_water);
    s.image[d] = Field<FaceImage>(s.grid.count());
    s.flow[d] = Field<FaceFlow>(s.grid.count());
    s.rest[d] = Field<FaceRest>(s.grid.count());
    s.flux[d] = Field<double>(s.grid.count());
    s.flux_response[d] = Field<double>(s.grid.count());
    s.speeds[d] = Field<FaceSpeeds>(s.grid.count());
    if (s.constants.kernel == Kernel::linear) s.follower[d] = Field<Follower>(s.grid.count());
  }
  s.cell_sums = Field<CellSums>(s.grid.count());
  s.cell = Field<CellState>(s.grid.count());
  s.pressure = Field<double>(s.grid.count());
  s.pressure_old = Field<double>(s.grid.count());
  s.pressure_before = Field<double>(s.grid.count());
  wish_large_pages_if_full(s);
  for (const Load& load : scene.loads)
    if (load.kind == Load::Kind::traction)
      s.loads.push_back(make_load<D>(scene, load, s));
    else
      s.plates.push_back(make_plate<D>(load));
  if (s.constants.transfer == Transfer::apic) {
    carry_gradient(scene, s.soil);
    carry_gradient(scene, s.water);
  }
  enter_stage(scene, scene.stages.front(), s);
  if (s.fixed.size()) measure_fixed(s);
  set_ports(s);
  points_to_faces(s);
  mark_plates(s);  // knows where the soil is
  find_surface(s);
  set_initial_pressure(scene, s);
  set_initial_stress(scene, s);
  const auto add_momentum = [&](const auto& set) {
    for (std::size_t p = 0; p < set.size(); ++p)
      for (int d = 0; d < D; ++d) s.momentum[d] += set.mass[p] * set.v[p][d];
  };
  add_momentum(s.soil), add_momentum(s.water);
  return s;
}

template <int D>
void set_walls(const Scene& scene, const Stage& stage, State<D>& s) {
  SceneWalls<D> walls = make_walls<D>(scene, s.grid, stage.open_gates, s.removed);
  s.water_walls = std::move(walls.water);
  s.soil_walls = std::move(walls.soil);
  s.volume = kernel_volumes<D>(s.grid, s.water_walls, s.constants.kernel, scene.numerics.points_per_cell);
  // Only water, what counts its room and fixed grains measured with its kernels fold at them.
  if (!s.has_water && !s.counts_room && s.fixed.size() == 0) s.water_walls.drop_folds();
  if (s.ports.empty()) make_ports(walls.ports, s);
  for (const Port<D>& port : s.ports) s.water_walls.set_port_open(port.d, port.face, port.open);
}

template <int D>
void scale_limits(State<D>& s) {
  const Constants<D>& c = s.constants;
  for (std::size_t i = 0; i < c.soils.size(); ++i)
    s.constants.step_limits[i] = StepLimit(c.soils[i], c.water_density, c.water_compliance,
                                           bounding_edge(c.kernel, s.grid.h, c.points_per_cell), c.inertia);
}

template <int D>
void enter_stage(const Scene& scene, const Stage& stage, State<D>& s) {
  set_walls(scene, stage, s);
  set_levels(scene, stage, s);
  s.constants.damping = stage.damping;
  switch_loads(scene, stage, s);
  mark_plates(s);
}

template State<2> make_state<2>(const Scene&);
template State<3> make_state<3>(const Scene&);
template void set_walls<2>(const Scene&, const Stage&, State<2>&);
template void set_walls<3>(const Scene&, const Stage&, State<3>&);
template void scale_limits<2>(State<2>&);
template void scale_limits<3>(State<3>&);
template void enter_stage<2>(const Scene&, const Stage&, State<2>&);
template void enter_stage<3>(const Scene&, const Stage&, State<3>&);

}  // namespace quicksand

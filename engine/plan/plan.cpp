#include "engine/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/grid/scene_grid.hpp"
#include "engine/materials/stability.hpp"
#include "engine/plan/companions.hpp"
#include "engine/plan/quasi_static.hpp"
#include "engine/plan/soil_stiffness.hpp"
#include "engine/plan/step_bounds.hpp"
#include "engine/points/seeding.hpp"
#include "engine/scene/region.hpp"
#include "engine/scene/stages.hpp"
#include "engine/scene/text.hpp"
#include "engine/step/state.hpp"

namespace quicksand {
namespace {

/// Steps that end on every sample and frame (Run::until_event): as many as the longer of the two intervals'
/// parts needs.
double steps_between_events(const Scene& scene, double duration, double dt) {
  constexpr double rounding = 1e-9;
  const double part = std::min({scene.output.series_interval, scene.output.frame_interval, duration});
  return std::max(1.0, std::round(duration / part)) * std::max(1.0, std::ceil(part / dt * (1 - rounding)));
}

/// Whether the top of a body lies open to the air anywhere in a stage: no other wet body above its surface,
/// looked at in every column of cells.
bool reaches_air(const Scene& scene, std::size_t stage, const Body& body, double h) {
  const Bounds bounds = bounding_box(body.region);
  const int dimensions = scene.domain.dimension == Dimension::space ? 3 : 2;
  // Polygons and discs are extruded over the whole depth; a plane has one slice.
  const double front = dimensions == 2 ? 0 : std::max(bounds.min[2], scene.domain.min[2]);
  const double back = dimensions == 2                 ? h
                      : bounds.max[2] > bounds.min[2] ? bounds.max[2]
                                                      : scene.domain.max[2];
  for (double z = front + 0.5 * h; z < back; z += h) {
    const Region layer = dimensions == 2 ? body.region : at_depth(body.region, z);
    for (double x = bounds.min[0] + 0.5 * h; x < bounds.max[0]; x += h) {
      const Stretches column = stretches(layer, 1, x);
      if (column.empty()) continue;
      const Vec3 above{x, column.back()[1] + 0.25 * h, z};
      const bool covered = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& other) {
        return other.kind != BodyKind::soil && present(scene, stage, other.name) &&
               contains(other.region, above, dimensions);
      });
      if (!covered) return true;
    }
  }
  return false;
}

double initial_soil_limit(const Scene& scene, std::size_t stage, double h, double inertia) {
  double limit = std::numeric_limits<double>::infinity();
  for (const Body& body : scene.bodies) {
    if (body.kind == BodyKind::water || body.fixed || !present(scene, stage, body.name)) continue;
    const Soil& soil = scene.soils.at(body.soil);
    const double compliance = scene.water.bulk_modulus ? 1 / *scene.water.bulk_modulus : 0;
    const SoilMaterial material = SoilMaterial::from(soil, scene.water, usual_stress(scene, soil));
    const StepLimit limits(material, scene.water.density, compliance,
                           bounding_edge(scene.numerics.kernel, h, scene.numerics.points_per_cell), inertia);
    const double n = soil.porosity, modulus = initial_modulus(scene, body, material);
    const bool confined = body.kind == BodyKind::saturated_soil && !reaches_air(scene, stage, body, h);
    const double saturated = limits.saturated(n, modulus);
    limit = std::min(limit, confined ? saturated : std::min(limits.dry(n, modulus), saturated));
  }
  return limit;
}

/// StepLimit::fast_wave of the saturated soil; infinite without, or if the pressure is solved for.
double initial_fast_wave_limit(const Scene& scene, std::size_t stage, double h, double inertia) {
  double limit = std::numeric_limits<double>::infinity();
  if (scene.numerics.pressure == PressureScheme::implicit) return limit;
  for (const Body& body : scene.bodies) {
    if (body.kind != BodyKind::saturated_soil || body.fixed || !present(scene, stage, body.name)) continue;
    const Soil& soil = scene.soils.at(body.soil);
    const SoilMaterial material = SoilMaterial::from(soil, scene.water, usual_stress(scene, soil));
    const StepLimit limits(material, scene.water.density, 1 / scene.water.bulk_modulus.value(),
                           bounding_edge(scene.numerics.kernel, h, scene.numerics.points_per_cell), inertia);
    limit = std::min(limit, limits.fast_wave(soil.porosity, initial_modulus(scene, body, material)));
  }
  return limit;
}

/// Bytes that a run takes at a time.
struct Memory {
  double arrays = 0;  ///< points, faces and cells; the numbers of points that readers of the file ask for
  double saved = 0;   ///< the last good state; a checkpoint on its way to the disk is another one
  double frame = 0;   ///< see Frame in engine/run/run.hpp
  double chunks = 0;  ///< what the file's library takes to pack a frame
};

/// Frames after which a good state is kept before its time (Run::kHeldFrames, and the one that fills up).
constexpr double kMostTogether = 4;

/// Of a run of at least one step, of whose frames so many wait `together` for a good state, and so are there
/// with its checkpoint, and packed one after the other; where they come fast, one more is on its way.
double peak_memory(const Memory& m, double together, bool has_checkpoints) {
  const double frames = together + (together == kMostTogether ? 1 : 0);
  return m.arrays + (has_checkpoints ? 2 : 1) * m.saved + frames * m.frame + m.chunks;
}

/// Points, at most, in a chunk of the result file, and how many copies of their places are made on its way.
constexpr double kChunkPoints = 65536, kChunkCopies = 4;

/// Frame's fields that are asked for, all of them if none is named, and what a point takes in a frame.
struct FrameContent {
  int fields = 0, components = 0;
  double bytes_per_point() const {
    constexpr double bare = 3 * sizeof(double) + sizeof(std::int32_t) + sizeof(std::uint8_t);
    return bare + components * double{sizeof(float)};
  }
};
FrameContent frame_content(const std::vector<std::string>& wanted, int stress) {
  const std::pair<const char*, int> fields[] = {
      {"displacement", 3},          {"velocity", 3},       {"porosity", 1}, {"pore_pressure", 1},
      {"effective_stress", stress}, {"plastic_strain", 1}, {"head", 1}};
  FrameContent content;
  for (const auto& [name, components] : fields)
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end()) {
      ++content.fields;
      content.components += components;
    }
  return content;
}

/// Steps between two good states (RunOptions::good_every), and s before the first checkpoint.
constexpr double kGoodEvery = 128, kFirstCheckpoint = 0.25;

/// Frames that wait together for a good state: those between two of them, no more than Run::kHeldFrames
/// allows and than the run has after its first.
double frames_together(const Scene& scene, double dt, double end_time) {
  const double steps_between_frames = std::max(1.0, scene.output.frame_interval / dt);
  const double all = std::ceil(end_time / scene.output.frame_interval);
  return std::clamp(std::floor(kGoodEvery / steps_between_frames), 1.0, std::clamp(all, 1.0, kMostTogether));
}

bool damps(const Scene& scene) {
  return std::any_of(scene.stages.begin(), scene.stages.end(),
                     [](const Stage& stage) { return stage.damping > 0; });
}
/// State::keeps_flow and keeps_rest, as far as they are known before the run.
bool keeps_flow(const Scene& scene, bool water) {
  const auto is_plate = [](const Load& load) { return load.kind != Load::Kind::traction; };
  return water || damps(scene) || std::any_of(scene.loads.begin(), scene.loads.end(), is_plate);
}
bool keeps_rest(const Scene& scene, bool holds_soil) { return holds_soil || damps(scene); }

template <int D>
Memory measure(const Scene& scene, Plan& plan) {
  const Grid<D> grid = make_grid<D>(scene);
  const PointCounts points = count_points<D>(scene, grid);
  plan.soil_points = points.soil;
  plan.fixed_soil_points = points.fixed;
  plan.water_points = points.water;
  for (int d = 0; d < D; ++d) plan.cells[d] = grid.cells[d];
  const double affine = scene.numerics.transfer == Transfer::apic ? sizeof(Gradient<D>) : 0;
  const double follower = scene.numerics.kernel == Kernel::linear ? D * sizeof(Follower) : 0;
  const double per_soil =
      affine + 3 * sizeof(Vec<D>) + sizeof(Stress<D>) + 3 * sizeof(double) + 2 * sizeof(int) + 8;
  const double per_water = affine + 3 * sizeof(Vec<D>) + sizeof(double) + sizeof(int) + 8;
  const double fixed = points.fixed ? D * sizeof(FixedFace) + sizeof(CellSums) : 0;
  const double rest = keeps_rest(scene, points.fixed > 0) ? sizeof(FaceRest) : 0;
  const bool soil = points.soil + points.fixed > 0;
  const double flow = keeps_flow(scene, plan.has_water) ? sizeof(FaceFlow) : 0;
  const double of_soil = sizeof(MassSum) + (plan.has_water ? 0 : sizeof(double)), of_water = sizeof(MassSum),
               of_both = sizeof(ForceSum) + sizeof(RoomSum);
  const double sums =
      (soil ? of_soil : 0) + (plan.has_water ? of_water : 0) + (soil && plan.has_water ? of_both : 0);
  const double flux = plan.has_water ? 2 * sizeof(double) : 0;
  // What a step touches. Images lie beside walls only.
  // State::counts_room.
  const bool counts_room = plan.has_water || !scene.output.probes.empty() || !scene.loads.empty();
  const double wet =
      (plan.has_water ? double{sizeof(CellState)} : 0) + (counts_room ? double{sizeof(CellSums)} : 0);
  const double pressures = plan.has_water ? sizeof(double) : 0;
  const double per_active_cell =
      follower + fixed + wet + 3 * pressures + D * (sums + flow + flux + rest + sizeof(FaceSpeeds));
  const double kept_per_active_cell =  // of the last good state
      follower + wet + 2 * pressures + D * (flow + sizeof(FaceSpeeds) + 1);
  // Flags of walls, for water and for grains, and volumes about an axis.
  const double per_cell = 2 * (5 * D + 1 + sizeof(int)) + (grid.axial ? (D + 1) * sizeof(double) : 0);
  const double points_bytes = per_soil * static_cast<double>(plan.soil_points + plan.fixed_soil_points) +
                              per_water * static_cast<double>(plan.water_points);
  const double per_wet_cell = PressureSystem<D>::kBytesPerRow + Multigrid<D>::bytes_per_row();
  const double wet_cells = static_cast<double>(plan.water_points) / power(scene.numerics.points_per_cell, D);
  const auto active = static_cast<double>(points.active_cells);
  const auto count = static_cast<double>(plan.soil_points + plan.fixed_soil_points + plan.water_points);
  return {points_bytes + per_active_cell * active + per_wet_cell * wet_cells + per_cell * grid.count() +
              count * sizeof(long long),
          points_bytes + kept_per_active_cell * active,
          count * frame_content(scene.output.fields, kStress<D>).bytes_per_point(),
          kChunkCopies * std::min(count, kChunkPoints) * 3 * sizeof(double)};
}

void explain(const Scene& scene, Plan& plan) {
  const auto say = [&](bool yes, const char* with, const char* without) {
    plan.reasons.push_back(yes ? with : without);
  };
  say(plan.has_soil, "Grains: momentum balance, effective stress and porosity of the moving soil bodies.",
      "No soil moves: no grain velocities and no stress.");
  const bool solved = scene.numerics.pressure == PressureScheme::implicit;
  say(plan.has_water,
      solved ? "Water: momentum balance and one pressure per wet cell, solved implicitly."
             : "Water: momentum balance and one pressure per wet cell, advanced explicitly.",
      "No water: no water points, no pressure, no drag.");
  say(plan.has_viscosity, "Viscosity of the water: on its velocities, explicitly.", "No viscosity.");
  if (plan.fixed_soil_points)
    plan.reasons.push_back("Fixed soil resists the water and stops grains; its own stress is not computed.");
  if (scene.domain.dimension == Dimension::axisymmetric)
    plan.reasons.push_back("About an axis: x is the radius; masses, volumes and forces are per radian.");
  if (plan.has_water && !scene.water.bulk_modulus) plan.reasons.push_back("Water is incompressible.");
}

/// At the start of a stage, as far as it is known before the run.
StepSituation situation(const Scene& scene, std::size_t stage, const Plan& plan, double speed) {
  const double none = std::numeric_limits<double>::infinity(), h = plan.cell_size,
               inertia = slow_process(scene, stage).inertia;
  return {initial_soil_limit(scene, stage, h, inertia), speed, plan.has_water,
          plan.has_water ? initial_fast_wave_limit(scene, stage, h, inertia) : none, inertia};
}

/// What the companions of an error estimate cost besides, one after the other.
void add_companions(const Scene& scene, const Calibration& machine, Plan& plan) {
  const Companions others = companions(scene);
  for (const auto& other : {others.coarser, others.finer}) {
    if (!other) continue;
    const Plan cost = make_plan(other->scene, machine);
    plan.seconds += cost.seconds;
    plan.memory_bytes = std::max(plan.memory_bytes, cost.memory_bytes);
    plan.reasons.push_back("Discretisation error: told by another run with cells of " +
                           text(other->scene.cell_size()) + " m.");
  }
}

}  // namespace

double output_seconds(const Scene& scene, const Plan& plan, double end_time, const Calibration& machine) {
  const OutputCost& cost = machine.output;
  const double frames = 1 + std::ceil(end_time / scene.output.frame_interval);
  const double flushes = frames / frames_together(scene, plan.time_step, end_time);
  const auto points = static_cast<double>(plan.soil_points + plan.fixed_soil_points + plan.water_points);
  const int stress = plan.dimensions == 2 ? kStress<2> : kStress<3>;
  const FrameContent content = frame_content(scene.output.fields, stress);
  const double frame = cost.frame + points * cost.frame_point + content.fields * cost.field +
                       content.components * points * cost.component;
  return cost.start + points * cost.seed_point + frames * frame + flushes * cost.flush;
}

Plan make_plan(const Scene& scene, const Calibration& machine) {
  Plan plan;
  plan.dimensions = scene.domain.dimension == Dimension::space ? 3 : 2;
  plan.cell_size = scene.cell_size();
  plan.has_water = has_water(scene);
  const Memory memory = plan.dimensions == 2 ? measure<2>(scene, plan) : measure<3>(scene, plan);
  plan.has_soil = plan.soil_points > 0;
  plan.has_viscosity = plan.has_water && scene.water.viscosity > 0;
  explain(scene, plan);
  plan.stages = plan_stages(scene);

  double speed = 0;
  for (const Body& body : scene.bodies) {
    const Bounds box = bounding_box(body.region);
    const double radius = 0.5 * std::hypot(box.max[0] - box.min[0], box.max[1] - box.min[1]);
    speed = std::max(speed, std::hypot(body.velocity[0], body.velocity[1], body.velocity[2]) +
                                std::abs(body.rotation_rate) * radius);
  }
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    const StepSituation start = situation(scene, k, plan, speed);
    const StepBound bound = choose_step(scene, start);
    if (k == 0) {
      plan.bounds = step_bounds(scene, start);
      plan.bound = bound;
      plan.time_step = bound.seconds;
    }
    plan.end_time += scene.stages[k].duration;
    plan.steps += steps_between_events(scene, scene.stages[k].duration, bound.seconds);
  }
  plan.seconds =
      machine.seconds(scene, plan.steps, static_cast<double>(plan.soil_points + plan.water_points));
  plan.seconds += output_seconds(scene, plan, plan.end_time, machine);
  const double together = frames_together(scene, plan.time_step, plan.end_time);
  const bool fills_up =
      together == kMostTogether && plan.end_time > kMostTogether * scene.output.frame_interval;
  const bool has_good_states = plan.steps > kGoodEvery || fills_up;
  plan.memory_bytes = peak_memory(memory, together, has_good_states && plan.seconds > kFirstCheckpoint);
  add_companions(scene, machine, plan);
  plan.kind = error_class(scene);
  plan.expected_error = expected_error(scene);
  if (!scene.numerics.chosen.empty()) plan.reasons.push_back("Chosen: " + scene.numerics.chosen + ".");
  return plan;
}

}  // namespace quicksand

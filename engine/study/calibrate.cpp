#include "engine/study/calibrate.hpp"

#include <algorithm>
#include <ctime>

#include "engine/study/history.hpp"

namespace quicksand {

namespace {

Scene bed(SceneKind kind, int across) {
  const bool space = kind >= SceneKind::soil_space;
  const SceneKind plane = space ? static_cast<SceneKind>(static_cast<int>(kind) - 3) : kind;
  constexpr double h = 0.01;
  const double side = across * h, depth = space ? side : 0;
  Scene s;
  s.domain.dimension = space ? Dimension::space : Dimension::plane_strain;
  s.domain.cell_size = h;
  s.domain.max = {side, side + 4 * h, depth};
  Soil soil;
  soil.permeability.value = 1e-4;
  soil.model = {
      .law = SoilLaw::mohr_coulomb, .young_modulus = 1e7, .poisson_ratio = 0.3, .friction_angle = 30};
  if (plane != SceneKind::water) s.soils.emplace("soil", soil);
  const auto add = [&](const char* name, BodyKind body_kind, double from, double to) {
    Body body;
    body.name = name;
    body.kind = body_kind;
    body.region.min = {0, from, 0};
    body.region.max = {side, to, depth};
    if (body_kind != BodyKind::water) body.soil = "soil";
    s.bodies.push_back(body);
  };
  if (plane == SceneKind::water) add("pond", BodyKind::water, 0, side);
  if (plane == SceneKind::soil) add("bed", BodyKind::soil, 0, side);
  if (plane == SceneKind::both) {
    const double middle = h * (across / 2);
    add("bed", BodyKind::saturated_soil, 0, middle);
    add("pond", BodyKind::water, middle, side);
  }
  s.stages = {Stage{}};
  s.stages[0].name = "only";
  s.stages[0].duration = 1;
  s.output.frame_interval = s.output.series_interval = 1;
  s.numerics.time_step = 1e-5;
  return s;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Sample {
  double points = 0, per_step = 0;
};

/// The median of three runs: other work on the machine only ever slows one down.
Sample time_steps(Scene scene, double point_steps) {
  scene.numerics.max_steps = 1;
  RunMonitor monitor;
  HistorySink nowhere;
  const double points = run(scene, nowhere, monitor, {1}).point_steps;
  const double count = std::max(20.0, point_steps / points);
  scene.stages[0].duration = count * *scene.numerics.time_step;
  scene.output.frame_interval = scene.output.series_interval = scene.stages[0].duration;
  scene.numerics.max_steps = 100000;
  std::array<double, 3> taken{};
  for (double& t : taken) {
    HistorySink sink;
    const double before = cpu_seconds();
    const RunReport report = run(scene, sink, monitor, {1});
    t = (cpu_seconds() - before) / static_cast<double>(std::max(1L, report.steps));
  }
  std::sort(taken.begin(), taken.end());
  return {points, taken[1]};
}

}  // namespace

Scene calibration_scene(SceneKind kind, int across, long steps, int frames) {
  Scene s = bed(kind, across);
  s.name = "calibration";
  for (Body& body : s.bodies) body.velocity = {0.02, 0.05, 0}, body.rotation_rate = 0.5;
  s.stages[0].duration = static_cast<double>(steps) * *s.numerics.time_step;
  s.output.frame_interval = s.output.series_interval = s.stages[0].duration / (frames - 1);
  return s;
}

Calibration calibrate(double effort) {
  Calibration calibration;
  for (std::size_t k = 0; k < kSceneKinds; ++k) {
    const SceneKind kind = static_cast<SceneKind>(k);
    const bool space = kind >= SceneKind::soil_space;
    const Sample small = time_steps(bed(kind, space ? 4 : 6), effort * 1e5),
                 large = time_steps(bed(kind, space ? 12 : 60), effort * 6e5);
    StepCost& cost = calibration.cost[k];
    cost.point = std::max(1e-9, (large.per_step - small.per_step) / (large.points - small.points));
    cost.step = std::max(1e-7, small.per_step - cost.point * small.points);
  }
  return calibration;
}

}  // namespace quicksand

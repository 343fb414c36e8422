#include "engine/study/ladder.hpp"

#include "engine/scene/check.hpp"
#include "engine/scene/stages.hpp"
#include "engine/scene/text.hpp"

namespace quicksand {
namespace {

void vary_water(const Scene& scene, std::vector<Rung>& rungs) {
  const auto add = [&](const char* factor, std::string setting, auto change) {
    Rung rung{factor, std::move(setting), scene};
    change(rung.scene);
    rungs.push_back(std::move(rung));
  };
  if (scene.numerics.pressure == PressureScheme::implicit) {
    for (const double tolerance : {1e-4, 1e-8})
      add("pressure tolerance", text(tolerance),
          [&](Scene& s) { s.numerics.pressure_tolerance = tolerance; });
    if (scene.water.bulk_modulus)
      add("pressure", "explicit", [](Scene& s) { s.numerics.pressure = PressureScheme::explicit_scheme; });
  } else {
    add("pressure", "implicit", [](Scene& s) { s.numerics.pressure = PressureScheme::implicit; });
  }
  if (scene.water.bulk_modulus)
    for (const double part : {0.1, 0.01})
      add("water bulk modulus", text(part) + " ×",
          [&](Scene& s) { s.water.bulk_modulus = part * *scene.water.bulk_modulus; });
}

}  // namespace

std::vector<Rung> ladder(const Scene& original) {
  Scene scene = original;
  scene.numerics.error_estimate = ErrorEstimate::none;
  double end = 0;
  for (const Stage& stage : scene.stages) end += stage.duration;
  scene.output.frame_interval = std::max(end, scene.output.frame_interval);
  const Numerics& own = scene.numerics;
  std::vector<Rung> rungs{{"as given", text(scene.cell_size()) + " m", scene}};
  const auto add = [&](const char* factor, std::string setting, auto change) {
    Rung rung{factor, std::move(setting), scene};
    change(rung.scene.numerics);
    rungs.push_back(std::move(rung));
  };
  for (const double ratio : {4.0, 3.0, 2.0, 1.5, 0.75, 0.5})
    add("cell size", text(ratio * scene.cell_size()) + " m",
        [&](Numerics& n) { n.cell_size_factor *= ratio; });
  for (const int points : {1, 2, 3})
    if (points != own.points_per_cell)
      add("points per cell", std::to_string(points), [&](Numerics& n) { n.points_per_cell = points; });
  add("kernel", own.kernel == Kernel::linear ? "quadratic" : "linear",
      [](Numerics& n) { n.kernel = n.kernel == Kernel::linear ? Kernel::quadratic : Kernel::linear; });
  add("transfer", own.transfer == Transfer::apic ? "flip" : "apic",
      [](Numerics& n) { n.transfer = n.transfer == Transfer::apic ? Transfer::flip : Transfer::apic; });
  for (const double part : {0.5, 0.25})
    add("time step", text(part) + " ×", [&](Numerics& n) {
      if (n.time_step) n.time_step = *n.time_step * part;
      n.time_step_factor *= part;
    });
  if (has_water(scene)) vary_water(scene, rungs);
  add("cell size", text(0.25 * scene.cell_size()) + " m", [](Numerics& n) { n.cell_size_factor *= 0.25; });
  std::erase_if(rungs, [](const Rung& rung) { return !check(rung.scene).empty(); });
  return rungs;
}

}  // namespace quicksand

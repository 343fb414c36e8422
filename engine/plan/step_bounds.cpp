#include "engine/plan/step_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace quicksand {

std::vector<StepBound> step_bounds(const Scene& scene, const StepSituation& now) {
  const double h = scene.cell_size();
  const int dimensions = scene.domain.dimension == Dimension::space ? 3 : 2;
  std::vector<StepBound> bounds;
  if (std::isfinite(now.soil_limit)) bounds.push_back({"soil wave", now.soil_limit});
  if (now.max_speed > 0) bounds.push_back({"motion", 0.5 * h / now.max_speed});
  const double g = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]);
  if (now.has_water && g > 0) bounds.push_back({"surface wave", std::sqrt(h / g)});
  const double nu = scene.water.viscosity / scene.water.density;
  if (now.has_water && nu > 0) bounds.push_back({"viscosity", h * h / (2 * dimensions * nu)});
  return bounds;
}

StepBound choose_step(const Scene& scene, const StepSituation& now) {
  if (scene.numerics.time_step) return {"numerics.time_step", *scene.numerics.time_step};
  const auto bounds = step_bounds(scene, now);
  if (bounds.empty()) return {"frame interval", scene.output.frame_interval};
  StepBound least = *std::min_element(bounds.begin(), bounds.end(),
                                      [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
  least.seconds *= scene.numerics.time_step_factor;
  return least;
}

}  // namespace quicksand

#include "engine/plan/step_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace quicksand {
namespace {

int dimensions_of(const Scene& scene) { return scene.domain.dimension == Dimension::space ? 3 : 2; }

/// Next to an axis v/r² adds to the radial component's Laplacian: at r = h its largest eigenvalue is at most
/// 4.5/h² instead of 4/h² (Gershgorin's discs), an eighth of a dimension more.
constexpr double kAxialViscosity = 0.125;

/// The divergence sees a pressure's whole change of velocity, the points hand back only its smooth part s ≤ 1
/// in the next step: p' = (1−a) p − b V, V' = V + s (a/b) p with a = (c κ Δt)², stable for a ≤ 4/(2−s). Of
/// the shortest waves nearly nothing comes back (s = 0.02 in the plane), so that a ≤ 4 of the bare lattice is
/// halved.
constexpr double kTransferLoss = 2;

/// Bounds beyond which a step grows without limit: those of the waves that are advanced explicitly.
std::vector<StepBound> wave_bounds(const Scene& scene, const StepSituation& now) {
  std::vector<StepBound> bounds;
  if (std::isfinite(now.soil_limit)) bounds.push_back({"soil wave", now.soil_limit});
  if (now.has_water && scene.numerics.pressure == PressureScheme::explicit_scheme) {
    const double speed = std::sqrt(scene.water.bulk_modulus.value() / (now.inertia * scene.water.density));
    const double along_axis = std::min(scene.cell_size() / speed, now.fast_wave_limit);
    bounds.push_back({"water wave", along_axis / std::sqrt(kTransferLoss * dimensions_of(scene))});
  }
  return bounds;
}

}  // namespace

std::vector<StepBound> step_bounds(const Scene& scene, const StepSituation& now) {
  const double h = scene.cell_size();
  const double axial = scene.domain.dimension == Dimension::axisymmetric ? kAxialViscosity : 0;
  std::vector<StepBound> bounds = wave_bounds(scene, now);
  if (now.max_speed > 0) bounds.push_back({"motion", 0.5 * h / now.max_speed});
  const double g = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]);
  if (now.has_water && g > 0) bounds.push_back({"surface wave", std::sqrt(now.inertia * h / g)});
  const double nu = scene.water.viscosity / scene.water.density;
  if (now.has_water && nu > 0)
    bounds.push_back({"viscosity", now.inertia * h * h / (2 * (dimensions_of(scene) + axial) * nu)});
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

std::optional<StepBound> outrun_wave(const Scene& scene, const StepSituation& now, double seconds) {
  for (const StepBound& bound : wave_bounds(scene, now))
    if (seconds > bound.seconds) return bound;
  return {};
}

}  // namespace quicksand

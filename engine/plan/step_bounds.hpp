#pragma once
#include <limits>
#include <optional>
#include <vector>

#include "engine/plan/plan.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// What is known of the moving state when a step is chosen.
struct StepSituation {
  double soil_limit = 0;  ///< s, smallest stability bound of any soil point; infinite without soil
  double max_speed = 0;   ///< m/s
  bool has_water = true;
  /// s, smallest StepLimit::fast_wave of any saturated soil point; infinite unless the pressure is explicit.
  double fast_wave_limit = std::numeric_limits<double>::infinity();
  double inertia = 1;  ///< –, of a quasi-static stage; the limits of soil hold it already
};

/// All bounds of the next time step, before the scene's safety factor; each with its name:
/// "soil wave"      stress is explicit: von Neumann bound of the coupled scheme (materials/stability.hpp)
/// "water wave"     explicit pressure only: the fast wave of soil and water, or that of free water, on a
/// lattice
///                  of D dimensions with points that carry the velocity, h/(c √(2D))
/// "motion"         no point may cross more than half a cell
/// "surface wave"   the free surface follows the velocity explicitly: √(h/|g|)
/// "viscosity"      h²/(2 D ν), explicit
std::vector<StepBound> step_bounds(const Scene& scene, const StepSituation& now);

/// The chosen step: the smallest bound times `time_step_factor`, or the scene's fixed step.
StepBound choose_step(const Scene& scene, const StepSituation& now);

/// The wave that a step of `seconds` would not follow and therefore amplify; none if it is stable.
std::optional<StepBound> outrun_wave(const Scene& scene, const StepSituation& now, double seconds);

}  // namespace quicksand

#pragma once
#include <vector>

#include "engine/plan/plan.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// What is known of the moving state when a step is chosen.
struct StepSituation {
  double soil_limit = 0;  ///< s, smallest stability bound of any soil point; infinite without soil
  double max_speed = 0;   ///< m/s
  bool has_water = true;
};

/// All bounds of the next time step, before the scene's safety factor; each with its name:
/// "soil wave"      stress is explicit: von Neumann bound of the coupled scheme (materials/stability.hpp)
/// "motion"         no point may cross more than half a cell
/// "surface wave"   the free surface follows the velocity explicitly: √(h/|g|)
/// "viscosity"      h²/(2 D ν), explicit
std::vector<StepBound> step_bounds(const Scene& scene, const StepSituation& now);

/// The chosen step: the smallest bound times `time_step_factor`, or the scene's fixed step.
StepBound choose_step(const Scene& scene, const StepSituation& now);

}  // namespace quicksand

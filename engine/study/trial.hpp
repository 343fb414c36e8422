#pragma once
// What a run will take where nothing but a run can tell: flows that speed up, ground that stiffens, stages
// that end at rest.

#include <functional>
#include <string>
#include <vector>

#include "engine/plan/calibration.hpp"
#include "engine/plan/plan.hpp"
#include "engine/plan/step_bounds.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// By what a step was chosen.
struct Moment {
  std::size_t stage = 0;
  double time = 0;  ///< s, before the step
  StepSituation situation;
};

/// What a step takes in a run.
struct Pace {
  double points = 0, step = 0;  ///< –, s of processor time; 0: not measured
};

/// Short runs of a scene: on its own cells, to its end or for a while, and if that was not its end on larger
/// cells.
struct Trial {
  std::string missing;  ///< why there is none; empty otherwise
  TrialFigures figures;
  bool is_whole = false;        ///< it was the scene itself to its end, events and all
  std::vector<Moment> moments;  ///< in order of time
  double soil_limit = 0;        ///< s, of its soil at its start; infinite without
  /// s, duration of every stage that it came through; stages end before their time when at rest
  std::vector<double> durations;
  Pace larger, own;  ///< on larger cells; on the scene's own, as it would be in the mean of the whole run
};

/// Runs it on one core: on its own cells for half of `budget` seconds if something can be seen in that time;
/// then, unless that was all of it, on the smallest cells twice as large and more for which it should take
/// the other half, and on others when none of these fit the walls. Stopped after twice that half, or when
/// `stopped` says so.
Trial make_trial(const Scene& scene, const Calibration& machine, double budget,
                 const std::function<bool()>& stopped = {});

/// Replaces steps and seconds of the plan of a scene that differs from the trial's in its numerics only:
/// walks through the steps that it would choose, were its state at each time that of the trial.
void foretell(const Trial& trial, const Scene& scene, const Calibration& machine, Plan& plan);

}  // namespace quicksand

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

/// A run of a scene on larger cells.
struct Trial {
  std::string missing;  ///< why there is none; empty otherwise
  TrialFigures figures;
  std::vector<Moment> moments;  ///< in order of time
  double soil_limit = 0;        ///< s, of its soil at its start; infinite without
  /// s, duration of every stage that it came through; stages end before their time when at rest
  std::vector<double> durations;
  double dearness = 1;  ///< –, seconds of a step over what the calibration says of one
};

/// Runs it on one core, on the smallest cells twice as large and more for which it should take at most
/// `budget` seconds; on others when none of these fit the walls. Stopped after twice that time, or when
/// `stopped` says so.
Trial make_trial(const Scene& scene, const Calibration& machine, double budget,
                 const std::function<bool()>& stopped = {});

/// Replaces steps and seconds of the plan of a scene that differs from the trial's in its numerics only:
/// walks through the steps that it would choose, were its state at each time that of the trial.
void foretell(const Trial& trial, const Scene& scene, const Calibration& machine, Plan& plan);

}  // namespace quicksand

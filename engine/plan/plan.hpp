#pragma once
// What a run will model, allocate and cost.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/plan/calibration.hpp"
#include "engine/plan/expected_error.hpp"
#include "engine/plan/stage_plan.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// One upper bound of the time step. `name` is stable ("soil wave", "drag", "water speed", …).
struct StepBound {
  std::string name;
  double seconds = 0;
};

/// A short run of the same scene, on its own cells or larger ones, by which steps and seconds were foretold
/// (study/trial.hpp).
struct TrialFigures {
  double cell_size = 0;  ///< m
  long steps = 0;
  double seconds = 0;   ///< of processor time that it took
  double fraction = 1;  ///< of the simulated time that it came through
};

struct Plan {
  int dimensions = 2;
  std::array<int, 3> cells{1, 1, 1};
  double cell_size = 0;  ///< m
  bool has_soil = false, has_water = false, has_viscosity = false;
  std::vector<std::string> reasons;  ///< plain sentences: what is modelled or left out and why
  std::vector<StagePlan> stages;     ///< what each one does
  std::size_t soil_points = 0, fixed_soil_points = 0, water_points = 0;
  double memory_bytes = 0;
  double time_step = 0;  ///< s, at the start
  StepBound bound;       ///< the smallest of `bounds`
  std::vector<StepBound> bounds;
  double end_time = 0;  ///< s, sum of the stages' (longest) durations
  double steps = 0;
  double seconds = 0;  ///< estimated wall time on one core of this machine
  std::optional<TrialFigures> trial;
  ErrorClass kind = ErrorClass::smooth;
  double expected_error = 0;  ///< –, see expected_error.hpp
};

/// Estimated seconds of a run that ends at `end_time` (s) besides its steps: its file and frames.
double output_seconds(const Scene& scene, const Plan& plan, double end_time, const Calibration& machine);

/// Requires `check(scene)` to be empty.
Plan make_plan(const Scene& scene, const Calibration& machine = {});

}  // namespace quicksand

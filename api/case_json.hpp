#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/plan/plan.hpp"
#include "engine/run/run.hpp"
#include "engine/scene/scene.hpp"
#include "engine/study/error_estimate.hpp"
#include "engine/study/trial.hpp"

namespace quicksand {

struct ParsedCase {
  std::optional<Scene> scene;  ///< set exactly when `faults` is empty
  std::vector<Fault>
      faults;  ///< all of them: syntax, duplicate and unknown keys, types, ranges, check(scene)
};

/// Case text (`quicksand.case/1`) → Scene. `preset` replaces the case's own `numerics.preset`, target_error
/// and budget_seconds; without it these choose the cells, by the times of `machine`.
ParsedCase parse_case(const std::string& text, const std::optional<Preset>& preset = {},
                      const Calibration& machine = {});

/// The case with every default filled in (`cell_size` and preset choices included). Parsing it gives the
/// same scene.
std::string resolved_case(const Scene& scene);

std::string plan_json(const Plan& plan);
/// The plan of a valid case and, in `presets`, what each preset would cost or why it does not fit. What the
/// case says under `numerics` wins over a preset there too. Their steps and seconds follow the trial, if
/// there is one.
std::string estimate_json(const std::string& case_text, const Plan& plan, const Calibration& machine,
                          const std::optional<Trial>& trial = {});
/// `run.json`: status, failure, plan, ledger, headline figures, their error if it was estimated, cost.
std::string report_json(const Scene& scene, const Plan& plan, const RunReport& report,
                        const std::optional<ErrorEstimateReport>& error_estimate = {});

/// The draft-07 schema, as shipped in api/case.schema.json (compiled in).
const std::string& case_schema();

}  // namespace quicksand

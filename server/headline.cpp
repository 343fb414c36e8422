#include "server/headline.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <filesystem>

#include "server/progress_bar.hpp"
#include "server/run_json.hpp"

namespace quicksand {
namespace {

/// NaN when the report has no such number (a diverged run may hold none).
double number(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : NAN;
}

std::string word(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "?";
}

std::string heave_text(const Json& heave) {
  const double moved_at = number(heave, "time"), head = number(heave, "head_difference"),
               gradient = number(heave, "gradient"), critical = number(heave, "critical_gradient");
  std::string text;
  if (heave.find("moved") != heave.end() && heave["moved"] == true)
    text += fmt::format("  The sand moved at t = {:.3g} s.\n  Largest head difference until then {:.3g} m",
                        moved_at, head);
  else
    text += fmt::format("  The sand did not move.\n  Largest head difference {:.3g} m", head);
  text += fmt::format(", hydraulic gradient {:.3g}, critical gradient i_c {:.3g}\n", gradient, critical);
  text +=
      fmt::format("  Rise of the sand: {:.3g} mm at the end, {:.3g} mm at most; one grain moved {:.3g} mm\n",
                  1e3 * number(heave, "final_rise"), 1e3 * number(heave, "max_rise"),
                  1e3 * number(heave, "max_point_displacement"));
  return text;
}

/// Whether scaled inertia mattered, per quasi-static stage.
std::string inertia_text(const Json& stages) {
  std::string text;
  for (const Json& stage : stages) {
    const bool negligible = stage.value("negligible", false);
    text += fmt::format(
        "  Stage {}: inertia × {:.3g}; kinetic energy reached {:.2g} % of the strain energy, {}\n",
        word(stage, "stage"), number(stage, "inertia"), 100 * number(stage, "inertia_ratio"),
        negligible ? "inertia is negligible"
                   : "INERTIA IS NOT NEGLIGIBLE: raise numerics.quasi_static_transits");
  }
  return text;
}

/// What the answer's cells cost in accuracy, of what was asked for.
std::string error_text(const Json& estimate) {
  const auto missing = estimate.find("missing");
  if (missing != estimate.end() && missing->is_string())
    return "  No error estimate: " + missing->get<std::string>() + "\n";
  std::string text;
  const auto figures = estimate.find("figures");
  if (figures == estimate.end()) return text;
  for (const Json& figure : *figures) {
    const Json& end = figure["end"];
    const double component = number(figure, "component");
    text += fmt::format("  {}{}: {:.4g} ± {:.2g} {} at the end, ± {:.2g} over time (order {:.2g}, {})\n",
                        word(figure, "name"), component > 0 ? fmt::format("[{:.0f}]", component) : "",
                        number(figure, "value"), number(end, "error"), word(figure, "unit"),
                        number(figure["history"], "error"), number(end, "order"), word(end, "basis"));
  }
  return text;
}

std::string cautions_text(const Json& cautions) {
  std::string text;
  for (const Json& caution : cautions)
    if (caution.is_string()) text += "  CAUTION: " + caution.get<std::string>() + "\n";
  return text;
}

std::string cost_text(const Json& report) {
  const double wall = number(report, "wall_seconds");
  return fmt::format("  Simulated {:.4g} s in {} ({:.0f} steps, {:.3g} point-steps/s)\n",
                     number(report, "sim_time"), duration_text(wall), number(report, "steps"),
                     wall > 0 ? number(report, "point_steps") / wall : 0.0);
}

}  // namespace

std::string headline_text(const std::string& report) {
  const Json json = Json::parse(report, nullptr, false);
  if (!json.is_object()) return "run.json cannot be read\n";
  std::string text = fmt::format("{}: {}\n", word(json, "name"), word(json, "status"));
  if (const auto heave = json.find("headline"); heave != json.end() && heave->is_object())
    text += heave_text(*heave);
  if (const auto estimate = json.find("error_estimate"); estimate != json.end() && estimate->is_object())
    text += error_text(*estimate);
  if (const auto stages = json.find("quasi_static"); stages != json.end() && stages->is_array())
    text += inertia_text(*stages);
  if (const auto ledger = json.find("ledger"); ledger != json.end() && ledger->is_object())
    text += fmt::format("  Water volume drifted by {:.2g} % at most\n",
                        100 * number(*ledger, "water_volume_drift_max"));
  if (const auto cautions = json.find("cautions"); cautions != json.end() && cautions->is_array())
    text += cautions_text(*cautions);
  return text + cost_text(json);
}

std::string files_text(const std::string& folder) {
  const std::string base = (std::filesystem::path(folder) / "result").string();
  return fmt::format(
      "Files in {0}: result.vtkhdf, result.xdmf, run.json\n"
      "  ParaView: open {1}.xdmf with the \"XDMF Reader\"\n"
      "  Python:   python3 -c \"import h5py; f = h5py.File('{1}.vtkhdf'); print(list(f['frames']))\"\n",
      folder, base);
}

}  // namespace quicksand

#include "server/tradeoff_run.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "api/case_json.hpp"
#include "server/files.hpp"

namespace quicksand {
namespace {

using Json = nlohmann::ordered_json;

/// `run.json` of a ladder.
std::string report(const Scene& scene, const Tradeoff& tradeoff) {
  Json rungs = Json::array();
  for (const RungResult& r : tradeoff.rungs) {
    const bool known = r.missing.empty() && !r.reference;
    rungs.push_back({{"factor", r.factor},
                     {"setting", r.setting},
                     {"error", known ? Json(r.error) : Json(nullptr)},
                     {"cpu_seconds", r.cpu_seconds},
                     {"memory_bytes", r.memory_bytes},
                     {"steps", r.steps},
                     {"point_steps", r.point_steps},
                     {"front", r.on_front},
                     {"reference", r.reference},
                     {"missing", r.missing.empty() ? Json(nullptr) : Json(r.missing)}});
  }
  const bool whole = tradeoff.status == RunStatus::succeeded;
  const Json json{{"name", scene.name},
                  {"kind", "tradeoff"},
                  {"status", whole ? "succeeded" : "canceled"},
                  {"reference", tradeoff.reference},
                  {"rungs", rungs}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

Execution execute_tradeoff(const std::string& case_text, const std::optional<Preset>& preset,
                           const std::string& folder, RunMonitor& monitor, const TradeoffOptions& options,
                           const Calibration& machine) {
  Execution execution;
  ParsedCase parsed = parse_case(case_text, preset, machine);
  if (!parsed.scene) {
    execution.faults = std::move(parsed.faults);
    return execution;
  }
  try {
    const Tradeoff tradeoff =
        measure_tradeoff(*parsed.scene, options.reference, options.threads, options.budget, monitor);
    execution.report.status = tradeoff.status;
    if (tradeoff.status == RunStatus::suspended) return execution;
    const std::filesystem::path to(folder);
    std::filesystem::create_directories(to);
    write_atomically(to / "tradeoff.csv", tradeoff_csv(tradeoff));
    write_atomically(to / "tradeoff.svg", tradeoff_svg(tradeoff, parsed.scene->name));
    write_atomically(to / "tradeoff.png", tradeoff_png(tradeoff, parsed.scene->name));
    write_atomically(to / "run.json", report(*parsed.scene, tradeoff));
  } catch (const std::filesystem::filesystem_error& error) {
    execution.report.status = RunStatus::failed;
    execution.report.failure = {
        "output", "cannot create the output folder: " + error.code().message(), 0, {}};
  } catch (const std::runtime_error& error) {
    execution.report.status = RunStatus::failed;
    execution.report.failure = {"output", error.what(), 0, {}};
  }
  return execution;
}

}  // namespace quicksand

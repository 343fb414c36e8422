#include "server/execute.hpp"

#include <sys/sysinfo.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "api/case_json.hpp"
#include "engine/results/result_file.hpp"
#include "engine/study/error_estimate.hpp"
#include "server/files.hpp"
#include "server/version.hpp"

namespace quicksand {
namespace {

/// Units of everything in the result file.
constexpr const char* units_document =
    R"({"length": "m", "time": "s", "mass": "kg", "stress": "Pa", "pressure": "Pa", "velocity": "m/s",)"
    R"( "head": "m", "plane_strain": "extensive quantities per metre of thickness",)"
    R"( "axisymmetric": "extensive quantities per radian",)"
    R"( "sign": "stress tension positive, water pressure compression positive"})";

std::string processor_name() {
  std::ifstream facts("/proc/cpuinfo");
  for (std::string line; std::getline(facts, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// The machine that computed the run.
std::string host_document() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  struct sysinfo memory {};
  sysinfo(&memory);
  const nlohmann::ordered_json host{{"name", name.data()},
                                    {"processor", processor_name()},
                                    {"cores", std::thread::hardware_concurrency()},
                                    {"memory_bytes", memory.totalram * memory.mem_unit}};
  return host.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

RunReport failed(const std::string& code, const std::string& message) {
  RunReport report;
  report.status = RunStatus::failed;
  report.failure = {code, message, 0, {}};
  return report;
}

/// Runs a valid scene; exceptions mean that its results could not be stored.
RunReport run_into(const std::string& folder, const std::string& case_text, const Scene& scene,
                   RunMonitor& monitor, const RunOptions& options) {
  const Plan plan = make_plan(scene);
  ResultFile file(folder, {{"case", case_text},
                           {"case_resolved", resolved_case(scene)},
                           {"plan", plan_json(plan)},
                           {"units", units_document},
                           {"engine_version", engine_version},
                           {"host", host_document()}});
  HistorySink history(&file);
  const bool with_error = scene.numerics.error_estimate != ErrorEstimate::none;
  RunReport report = run(scene, with_error ? static_cast<ResultSink&>(history) : file, monitor, options);
  std::optional<ErrorEstimateReport> error;
  if (with_error) error = estimate_error(scene, report, history, monitor, options);
  const std::string text = report_json(scene, plan, report, error);
  file.document("report", text);
  file.close();
  write_atomically(std::filesystem::path(folder) / "run.json", text);
  return report;
}

}  // namespace

Execution execute(const std::string& case_text, const std::optional<Preset>& preset,
                  const std::string& folder, RunMonitor& monitor, const RunOptions& options) {
  Execution execution;
  try {
    ParsedCase parsed = parse_case(case_text, preset);
    if (!parsed.scene) {
      execution.faults = std::move(parsed.faults);
      return execution;
    }
    std::filesystem::create_directories(folder);
    execution.report = run_into(folder, case_text, *parsed.scene, monitor, options);
  } catch (const std::filesystem::filesystem_error& error) {
    execution.report = failed("output", "cannot create the output folder: " + error.code().message());
  } catch (const std::runtime_error& error) {
    execution.report = failed("output", error.what());
  } catch (const std::exception& error) {
    execution.report = failed("internal", error.what());
  }
  return execution;
}

}  // namespace quicksand

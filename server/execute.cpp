#include "server/execute.hpp"

#include <sys/sysinfo.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "api/case_json.hpp"
#include "engine/results/disk_space.hpp"
#include "engine/results/result_file.hpp"
#include "engine/run/engine_build.hpp"
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

using Documents = std::map<std::string, std::string>;

/// A result file, and where its run goes on from, if it does.
struct Opened {
  std::unique_ptr<ResultFile> file;
  std::optional<StoredCheckpoint> from;
};

/// Goes on from the newest checkpoint that can be used; without one there is no file.
Opened reopen(const std::string& folder, const Documents& documents, RunMonitor& monitor) {
  for (const auto& path : checkpoint_files(folder)) try {
      StoredCheckpoint from = read_checkpoint(path);
      if (from.identity != run_identity(documents))
        throw std::runtime_error("it is of another case or build of quicksand");
      auto file = std::make_unique<ResultFile>(folder, documents, &from);
      return {std::move(file), std::move(from)};
    } catch (const std::runtime_error& error) {
      if (disk_refusal(error.what()) != DiskRefusal::none) throw;  // it is good, and its time will come
      monitor.log(path.filename().string() + " cannot be used: " + error.what());
    }
  return {};
}

/// Whether a run failed because of what a kill had left of its results.
bool found_damage(const RunReport& report) {
  return report.status == RunStatus::failed && report.failure.code == "output" &&
         disk_refusal(report.failure.message) == DiskRefusal::none;
}

/// Runs a valid scene; exceptions mean that its results could not be stored.
RunReport run_into(const std::string& folder, const std::string& case_text, const Scene& scene,
                   RunMonitor& monitor, RunOptions options, Resume resume) {
  const Plan plan = make_plan(scene);
  const Documents documents{
      {"case", case_text},       {"case_resolved", resolved_case(scene)}, {"plan", plan_json(plan)},
      {"units", units_document}, {"engine_version", engine_version},      {"engine_build", engine_build()},
      {"host", host_document()}};
  // The history that its error is estimated from is kept in memory only: such a run starts again.
  const bool with_error = scene.numerics.error_estimate != ErrorEstimate::none;
  if (with_error && resume == Resume::if_possible) resume = Resume::never;
  if (with_error && resume == Resume::required)
    return failed("no_checkpoint",
                  "a run with numerics.error_estimate cannot be resumed; run it from its beginning");
  Opened opened;
  if (resume != Resume::never) opened = reopen(folder, documents, monitor);
  if (!opened.file && resume == Resume::required)
    return failed("no_checkpoint",
                  "the folder holds no checkpoint of this case and build; run it from its beginning");
  if (!opened.file) opened.file = std::make_unique<ResultFile>(folder, documents);
  options.resume = opened.from ? &opened.from->run : nullptr;
  std::error_code none;
  std::filesystem::remove(std::filesystem::path(folder) / "run.json", none);  // of a run that was suspended
  HistorySink history(opened.file.get());
  RunReport report =
      run(scene, with_error ? static_cast<ResultSink&>(history) : *opened.file, monitor, options);
  if (opened.from && found_damage(report)) {
    monitor.log("the interrupted run's results are damaged; the run starts from its beginning");
    opened = {};
    return run_into(folder, case_text, scene, monitor, options, Resume::never);
  }
  if (report.status == RunStatus::failed && report.failure.code == "output") return report;
  std::optional<ErrorEstimateReport> error;
  if (with_error) error = estimate_error(scene, report, history, monitor, options);
  const std::string text = report_json(scene, plan, report, error);
  opened.file->document("report", text);
  opened.file->close();
  write_atomically(std::filesystem::path(folder) / "run.json", text);
  if (report.status != RunStatus::suspended) remove_checkpoints(folder);
  return report;
}

}  // namespace

Execution execute(const std::string& case_text, const std::optional<Preset>& preset,
                  const std::string& folder, RunMonitor& monitor, const RunOptions& options, Resume resume,
                  const Calibration& machine) {
  Execution execution;
  try {
    ParsedCase parsed = parse_case(case_text, preset, machine);
    if (!parsed.scene) {
      execution.faults = std::move(parsed.faults);
      return execution;
    }
    std::filesystem::create_directories(folder);
    execution.report = run_into(folder, case_text, *parsed.scene, monitor, options, resume);
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

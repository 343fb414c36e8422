#include <atomic>
#include <csignal>
#include <filesystem>
#include <iostream>

#include "api/case_json.hpp"
#include "server/calibration_file.hpp"
#include "server/commands.hpp"
#include "server/execute.hpp"
#include "server/files.hpp"
#include "server/headline.hpp"
#include "server/progress_bar.hpp"

namespace quicksand {
namespace {

/// Set by Ctrl-C and SIGTERM; the run ends within one step, keeps what it has and can be resumed.
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler may set it

class TerminalMonitor final : public RunMonitor {
 public:
  void progress(const Progress& now) override { bar_.draw(now); }
  void log(const std::string& line) override { notes_ += line + '\n'; }
  bool suspended() override { return interrupted; }
  const std::string& notes() const { return notes_; }
  void finish() { bar_.finish(); }

 private:
  ProgressBar bar_;
  std::string notes_;
};

/// A file of an earlier run in the folder, finished or left behind; empty if there is none.
std::string earlier_result(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : {"result.vtkhdf", "result.vtkhdf.part", "result.xdmf", "run.json"})
    if (std::filesystem::exists(folder / name, ignored)) return (folder / name).string();
  return {};
}

}  // namespace

const char* preset_name(Preset preset) {
  switch (preset) {
    case Preset::draft:
      return "draft";
    case Preset::fine:
      return "fine";
    case Preset::standard:
      break;
  }
  return "standard";
}

std::optional<std::string> read_case_file(const std::string& file) {
  auto text = read_text(file);
  if (!text) std::cerr << "cannot read " << file << '\n';
  return text;
}

void print_faults(const std::string& what, const std::vector<Fault>& faults) {
  std::cerr << what << " cannot be run:\n";
  for (const Fault& fault : faults)
    std::cerr << "  " << (fault.pointer.empty() ? "(whole case)" : fault.pointer) << ": " << fault.detail
              << '\n';
}

int run_command(const RunCommand& command) {
  const auto text = read_case_file(command.case_file);
  if (!text) return exit_status::bad_input;
  if (const std::string earlier = earlier_result(command.out);
      !earlier.empty() && !command.overwrite && !command.resume) {
    std::cerr << earlier << " exists: give another folder to --out, --overwrite to replace that run, or "
              << "--resume to go on with it\n";
    return exit_status::not_written;
  }
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  Execution done;
  {
    TerminalMonitor monitor;
    RunOptions options;
    options.threads = command.threads;
    options.checkpoint_interval = command.checkpoint_interval;
    done = execute(*text, command.preset, command.out, monitor, options,
                   command.resume ? Resume::required : Resume::never, read_calibration(user_calibration()));
    monitor.finish();
    if (done.report.failure.code == "no_checkpoint") std::cerr << monitor.notes();
  }
  if (!done.faults.empty()) {
    print_faults(command.case_file, done.faults);
    return exit_status::bad_input;
  }
  if (done.report.status == RunStatus::failed)
    std::cerr << "failed (" << done.report.failure.code << "): " << done.report.failure.message << '\n';
  if (done.report.failure.code == "no_checkpoint") return exit_status::bad_input;
  if (done.report.status == RunStatus::failed && done.report.failure.code == "output")
    return exit_status::not_written;
  const auto report = read_text(std::filesystem::path(command.out) / "run.json");
  if (report) std::cout << headline_text(*report) << files_text(command.out);
  if (done.report.status == RunStatus::suspended)
    std::cout << "stopped; to go on: quicksand run " << command.case_file << " --out " << command.out
              << " --resume\n";
  return done.report.status == RunStatus::succeeded ? exit_status::ok : exit_status::failed;
}

int schema_command() {
  std::cout << case_schema();
  return exit_status::ok;
}

int check_command(const std::string& case_file, const std::optional<Preset>& preset, double trial_seconds) {
  const auto text = read_case_file(case_file);
  if (!text) return exit_status::bad_input;
  const Calibration machine = read_calibration(user_calibration());
  const ParsedCase parsed = parse_case(*text, preset, machine);
  if (!parsed.scene) {
    print_faults(case_file, parsed.faults);
    return exit_status::bad_input;
  }
  Plan plan = make_plan(*parsed.scene, machine);
  std::optional<Trial> trial;
  if (trial_seconds > 0) {
    trial = make_trial(*parsed.scene, machine, trial_seconds);
    foretell(*trial, *parsed.scene, machine, plan);
  }
  std::cout << estimate_json(*text, plan, machine, trial) << '\n';
  return exit_status::ok;
}

}  // namespace quicksand

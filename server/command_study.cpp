// What accuracy costs, and how fast this machine is.

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "api/case_json.hpp"
#include "engine/study/calibrate.hpp"
#include "server/calibrate_output.hpp"
#include "server/calibration_file.hpp"
#include "server/commands.hpp"
#include "server/files.hpp"
#include "server/progress_bar.hpp"
#include "server/tradeoff_run.hpp"

namespace quicksand {

int tradeoff_command(const TradeoffCommand& command) {
  const auto text = read_case_file(command.case_file);
  if (!text) return exit_status::bad_input;
  const ParsedCase parsed = parse_case(*text, command.preset, read_calibration(user_calibration()));
  if (!parsed.scene) {
    print_faults(command.case_file, parsed.faults);
    return exit_status::bad_input;
  }
  std::vector<Curve> reference;
  if (!command.reference.empty()) {
    const auto table = read_case_file(command.reference);
    if (!table) return exit_status::bad_input;
    try {
      reference = curves_from_csv(*table);
    } catch (const std::runtime_error& error) {
      std::cerr << command.reference << ": " << error.what() << '\n';
      return exit_status::bad_input;
    }
  }
  RunMonitor monitor;
  if (command.out.empty()) {
    std::cout << tradeoff_csv(
        measure_tradeoff(*parsed.scene, reference, command.threads, command.budget, monitor));
    return exit_status::ok;
  }
  const Execution done = execute_tradeoff(*text, command.preset, command.out, monitor,
                                          {std::move(reference), command.threads, command.budget},
                                          read_calibration(user_calibration()));
  if (done.report.status == RunStatus::failed) {
    std::cerr << command.out << ": " << done.report.failure.message << '\n';
    return exit_status::not_written;
  }
  std::cout << read_text(std::filesystem::path(command.out) / "tradeoff.csv").value_or("");
  return exit_status::ok;
}

int calibrate_command(const std::string& state) {
  const std::filesystem::path file = state.empty() ? user_calibration() : state_calibration(state);
  try {
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
    Calibration measured;
    measured.output = calibrate_output(file.parent_path());  // first: it counts what the process has taken
    measured.cost = calibrate().cost;
    std::cout << calibration_json(measured);
    write_atomically(file, calibration_json(measured));
  } catch (const std::exception& error) {
    std::cerr << file.string() << ": " << error.what() << '\n';
    return exit_status::not_written;
  }
  return exit_status::ok;
}

}  // namespace quicksand

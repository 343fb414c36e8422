#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <iostream>

#include "server/catalogue.hpp"
#include "server/commands.hpp"
#include "server/files.hpp"
#include "server/serve.hpp"

namespace quicksand {
namespace {

/// Defaults, then the file, then the command line. Prints what is wrong and returns nothing then.
std::optional<Settings> read_all_settings(const ServeCommand& command) {
  Settings settings;
  settings.cases = find_cases().string();
  std::vector<Fault> faults;
  if (!command.config.empty()) {
    const auto text = read_text(command.config);
    if (!text) {
      std::cerr << "cannot read " << command.config << '\n';
      return {};
    }
    faults = read_settings(*text, settings);
  }
  for (const auto& [name, value] : command.set) {
    const std::string text = name == "port" && value == "auto" ? "0" : value;
    if (const std::string wrong = set(settings, name, text); !wrong.empty())
      faults.push_back({"command line", wrong});
  }
  for (const Fault& fault : faults) {
    const bool file = fault.pointer != "command line";
    std::cerr << (file ? command.config + ": " : "") << fault.pointer << ": " << fault.detail << '\n';
  }
  if (!faults.empty()) return {};
  return settings;
}

void start_log(const std::string& level) {
  auto log = spdlog::stderr_logger_mt("server");
  log->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  log->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(log);
}

}  // namespace

int serve_command(const ServeCommand& command) {
  const auto settings = read_all_settings(command);
  if (!settings) return exit_status::bad_input;
  if (command.print) {
    std::cout << print_settings(*settings);
    return exit_status::ok;
  }
  if (settings->state.empty()) {
    std::cerr << "no state folder: give --state DIR, or state = DIR in the configuration file\n";
    return exit_status::bad_input;
  }
  start_log(settings->log_level);
  try {
    serve(*settings);
    return exit_status::ok;
  } catch (const std::exception& error) {
    std::cerr << "cannot serve: " << error.what() << '\n';
    return exit_status::failed;
  }
}

}  // namespace quicksand

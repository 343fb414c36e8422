#pragma once
// Everything that can be set about a server: one struct of defaults and one table that documents it.

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

using Count = std::int64_t;

struct Settings {
  std::string host = "127.0.0.1";
  Count port = 8080;
  std::string state, cases;
  std::string log_level = "info";

  Count workers = 2;
  Count short_workers = 1;
  Count short_run_s = 600;
  Count threads_per_run = 0;
  Count points_per_thread = 5000;
  Count niceness = 10;

  Count checkpoint_s = 60;

  Count max_body_bytes = 4 << 20;
  Count max_queued = 1000;
  Count max_runs_per_key = 100;
  Count max_points = 20'000'000;
  Count max_memory = 0;
  Count max_run_s = 7 * 24 * 3600;

  Count disk_reserve = 1LL << 30;
  Count disk_quota = 0;
  Count keep_days = 0;

  std::string cors_origin;

  Count max_page = 200;
  Count max_wait_s = 30;
  Count max_waiters = 16;
  Count max_streams = 16;
  Count max_readers = 4;
  Count max_downloads = 32;
  Count max_trials = 1;
  Count max_data_bytes = 16 << 20;
};

/// One line of the configuration file.
struct Setting {
  enum class Kind { text, count, bytes } kind;
  const char* name;
  std::variant<std::string Settings::*, Count Settings::*> place;
  Count least, most;  ///< of a number
  const char* help;   ///< what it does, unit, what 0 means; lines end with '\n' but for the last
};

/// In the order of the configuration file.
const std::vector<Setting>& settings_table();

/// Takes `value` for the setting `name`; what is wrong with it otherwise, in one sentence, empty if nothing.
std::string set(Settings& settings, const std::string& name, const std::string& value);

/// Reads lines `name = value`; '#' begins a comment. `pointer` of a fault is "line N".
std::vector<Fault> read_settings(const std::string& text, Settings& settings);

/// A configuration file that `read_settings` reads back, every setting with its documentation.
std::string print_settings(const Settings& settings);

/// "200 (max_page)": a limit in a message, with the setting that moves it.
std::string named_limit(const Settings& settings, Count Settings::*place);

}  // namespace quicksand

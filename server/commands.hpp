#pragma once
// The sub-commands of `quicksand`. Each returns the process's exit status.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

namespace exit_status {
constexpr int ok = 0;
constexpr int failed = 1;       ///< the run failed or was canceled, or the server refused
constexpr int bad_input = 2;    ///< every fault of the case is on standard error
constexpr int not_written = 3;  ///< the results could not be stored, or would replace others
constexpr int no_server = 4;    ///< nobody answers at the URL
}  // namespace exit_status

struct RunCommand {
  std::string case_file, out;
  std::optional<Preset> preset;
  int threads = 0;
  bool overwrite = false;           ///< replace the results that `out` holds already
  bool resume = false;              ///< go on from the last checkpoint in `out`
  double checkpoint_interval = 60;  ///< s
};
int run_command(const RunCommand& command);

/// `trial_seconds`: see make_trial; 0: none.
int check_command(const std::string& case_file, const std::optional<Preset>& preset, double trial_seconds);

struct TradeoffCommand {
  std::string case_file, out, reference;
  std::optional<Preset> preset;
  int threads = 1;
  double budget = 0;  ///< s of CPU time; 0: none
};
/// Prints the ladder's table; with `out`, leaves it there with its picture.
int tradeoff_command(const TradeoffCommand& command);

/// Measures how fast this machine is, for the command line or for the service with this state folder.
int calibrate_command(const std::string& state);

/// Prints the schema of case files.
int schema_command();

struct ServeCommand {
  std::string config;                                    ///< file of settings; empty: none
  bool print = false;                                    ///< print the settings instead
  std::vector<std::pair<std::string, std::string>> set;  ///< settings of the command line, which win
};
int serve_command(const ServeCommand& command);

/// On the records in the folder `state`, whether a server runs there or not.
int create_key_command(const std::string& state, const std::string& name, const std::string& role);
int list_keys_command(const std::string& state);
int revoke_key_command(const std::string& state, const std::string& id);

struct SubmitCommand {
  std::string case_file, url, label;
  std::optional<Preset> preset;
  int priority = 0;
  bool tradeoff = false;      ///< the ladder instead of the case
  std::optional<int> budget;  ///< s of CPU time for it; absent: the service's default
  bool wait = false;
};
int submit_command(const SubmitCommand& command);

/// One run, or with an empty `id` the latest ones.
int status_command(const std::string& url, const std::string& id);
int fetch_command(const std::string& url, const std::string& id, const std::string& out);
int cancel_command(const std::string& url, const std::string& id);
int log_command(const std::string& url, const std::string& id);
int delete_command(const std::string& url, const std::string& id);

/// "draft", "standard", "fine".
const char* preset_name(Preset preset);

/// Text of a case file; prints why and returns nothing when it cannot be read.
std::optional<std::string> read_case_file(const std::string& file);
void print_faults(const std::string& what, const std::vector<Fault>& faults);

}  // namespace quicksand

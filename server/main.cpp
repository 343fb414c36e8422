// Wires the command line to the commands.

#include <CLI/CLI.hpp>
#include <iostream>

#include "engine/run/engine_build.hpp"
#include "server/commands.hpp"
#include "server/version.hpp"

namespace quicksand {
namespace {

const std::map<std::string, Preset> presets{
    {"draft", Preset::draft}, {"standard", Preset::standard}, {"fine", Preset::fine}};

/// What the command line was read into, and the exit status of the chosen command.
struct CommandLine {
  RunCommand run;
  std::string check_case;
  TradeoffCommand tradeoff;
  std::string calibrate_state;
  SubmitCommand submit;
  ServeCommand serve;
  std::optional<Preset> check_preset;
  double trial_seconds = 1;
  std::string id, out, url = "http://127.0.0.1:8080";
  std::string key_state, key_name, key_role = "submit", key_id;
  int status = 0;
};

void add_url(CLI::App* command, CommandLine& line) {
  command->footer("A service with API keys wants one in the environment: QUICKSAND_KEY.");
  command->add_option("--url", line.url, "the server")->envname("QUICKSAND_URL")->capture_default_str();
}

void add_preset(CLI::App* command, std::optional<Preset>& preset) {
  command
      ->add_option_function<std::string>(
          "--preset", [&preset](const std::string& name) { preset = presets.at(name); },
          "replaces the case's numerics.preset")
      ->check(CLI::IsMember({"draft", "standard", "fine"}));
}

void add_local_commands(CLI::App& app, CommandLine& line) {
  CLI::App* run = app.add_subcommand("run", "compute a case here");
  run->add_option("CASE", line.run.case_file, "case file (JSON)")->required();
  run->add_option("--out", line.run.out, "folder of the results")->required();
  add_preset(run, line.run.preset);
  run->add_option("--threads", line.run.threads, "0: all cores")->check(CLI::Range(0, 1024));
  run->add_flag("--overwrite", line.run.overwrite, "replace an earlier run's results in that folder");
  run->add_flag("--resume", line.run.resume, "go on from the last checkpoint in that folder")
      ->excludes("--overwrite");
  run->add_option("--checkpoint-interval", line.run.checkpoint_interval,
                  "s between two checkpoints, the first ones sooner; 0: only when it is stopped")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  run->callback([&line] { line.status = run_command(line.run); });

  CLI::App* check = app.add_subcommand("check", "print what a case would compute, or its faults");
  check->add_option("CASE", line.check_case, "case file (JSON)")->required();
  add_preset(check, line.check_preset);
  check
      ->add_option("--trial", line.trial_seconds,
                   "s for a trial: the case for a while, then on larger cells to its end; steps and seconds "
                   "follow it; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 3600.0));
  check->callback(
      [&line] { line.status = check_command(line.check_case, line.check_preset, line.trial_seconds); });

  CLI::App* tradeoff = app.add_subcommand("tradeoff", "error and cost of a case under other settings");
  tradeoff->add_option("CASE", line.tradeoff.case_file, "case file (JSON)")->required();
  tradeoff->add_option("--out", line.tradeoff.out, "folder for tradeoff.csv, .svg and .png, and run.json");
  tradeoff->add_option("--reference", line.tradeoff.reference,
                       "CSV of curves: time, then series by name; if absent, the run with the finest cells");
  tradeoff->add_option("--threads", line.tradeoff.threads, "0: all cores")->check(CLI::Range(0, 1024));
  tradeoff->add_option("--budget", line.tradeoff.budget, "s of CPU time for all of it; 0: no end")
      ->check(CLI::Range(0.0, 1e9));
  add_preset(tradeoff, line.tradeoff.preset);
  tradeoff->callback([&line] { line.status = tradeoff_command(line.tradeoff); });

  CLI::App* calibrate = app.add_subcommand("calibrate", "measure this machine, for estimates of time");
  calibrate->add_option("--state", line.calibrate_state,
                        "folder of a service, which reads it as it starts; if absent, for `quicksand check`");
  calibrate->callback([&line] { line.status = calibrate_command(line.calibrate_state); });

  CLI::App* schema = app.add_subcommand("schema", "print the schema of case files");
  schema->callback([&line] { line.status = schema_command(); });
}

/// An option that sets `setting`, whatever the configuration file says.
void add_setting(CLI::App* serve, CommandLine& line, const char* option, const char* setting,
                 const char* help) {
  serve->add_option_function<std::string>(
      option,
      [&line, setting](const std::string& value) {
        line.serve.set.push_back({setting, value});
      },
      help);
}

void add_serve_command(CLI::App& app, CommandLine& line) {
  CLI::App* serve = app.add_subcommand("serve", "answer HTTP and compute what is submitted");
  serve->add_option("--config", line.serve.config, "file of settings");
  serve->add_flag("--print-config", line.serve.print, "print every setting with its documentation and stop");
  add_setting(serve, line, "--state", "state", "folder of the runs and their records");
  add_setting(serve, line, "--host", "host", "address to listen at");
  add_setting(serve, line, "--port", "port", "TCP port; 0 or auto: the first free one from 8080");
  add_setting(serve, line, "--workers", "workers", "runs computed at a time");
  add_setting(serve, line, "--threads", "threads_per_run", "threads per run; 0: all cores");
  add_setting(serve, line, "--cases", "cases", "folder of shipped cases");
  add_setting(serve, line, "--log-level", "log_level", "debug, info, warning or error");
  serve->add_option_function<std::vector<std::string>>(
      "--set",
      [&line](const std::vector<std::string>& pairs) {
        for (const std::string& pair : pairs) {
          const auto equals = std::min(pair.find('='), pair.size());
          line.serve.set.push_back({pair.substr(0, equals), pair.substr(std::min(equals + 1, pair.size()))});
        }
      },
      "NAME=VALUE: any setting of --print-config");
  serve->callback([&line] { line.status = serve_command(line.serve); });
}

void add_key_commands(CLI::App& app, CommandLine& line) {
  CLI::App* keys = app.add_subcommand("keys", "who may use a service: create, list and revoke API keys");
  keys->require_subcommand(1);
  keys->add_option("--state", line.key_state, "folder of the service's records")->required();
  CLI::App* create = keys->add_subcommand("create", "make a key and print it once");
  create->add_option("NAME", line.key_name, "whose it is; runs belong to the name")->required();
  create->add_option("--role", line.key_role, "read: sees all runs; submit: its own runs; admin: everything")
      ->check(CLI::IsMember({"read", "submit", "admin"}))
      ->capture_default_str();
  create->callback(
      [&line] { line.status = create_key_command(line.key_state, line.key_name, line.key_role); });
  keys->add_subcommand("list", "all keys, revoked ones too")->callback([&line] {
    line.status = list_keys_command(line.key_state);
  });
  CLI::App* revoke = keys->add_subcommand("revoke", "end a key at once");
  revoke->add_option("ID", line.key_id, "first column of the list")->required();
  revoke->callback([&line] { line.status = revoke_key_command(line.key_state, line.key_id); });
}

/// A command about one run that needs nothing but its id.
void add_run_command(CLI::App& app, CommandLine& line, const char* name, const char* help,
                     int (*command)(const std::string& url, const std::string& id)) {
  CLI::App* sub = app.add_subcommand(name, help);
  sub->add_option("ID", line.id, "run")->required();
  add_url(sub, line);
  sub->callback([&line, command] { line.status = command(line.url, line.id); });
}

void add_remote_commands(CLI::App& app, CommandLine& line) {
  CLI::App* submit = app.add_subcommand("submit", "send a case to a server");
  submit->add_option("CASE", line.submit.case_file, "case file (JSON)")->required();
  add_url(submit, line);
  add_preset(submit, line.submit.preset);
  submit->add_option("--label", line.submit.label, "a word to find the run by");
  submit->add_option("--priority", line.submit.priority, "-10 to 10, higher ones first; above 0 for admins");
  submit->add_flag("--tradeoff", line.submit.tradeoff, "measure the case's ladder instead of running it");
  submit->add_option("--budget", line.submit.budget, "with --tradeoff: s of CPU time for all of it")
      ->check(CLI::Range(1, 1'000'000))
      ->needs("--tradeoff");
  submit->add_flag("--wait", line.submit.wait, "show progress until it ends");
  submit->callback([&line] {
    line.submit.url = line.url;
    line.status = submit_command(line.submit);
  });

  CLI::App* status = app.add_subcommand("status", "show one run, or the latest ones");
  status->add_option("ID", line.id, "run");
  add_url(status, line);
  status->callback([&line] { line.status = status_command(line.url, line.id); });

  CLI::App* fetch = app.add_subcommand("fetch", "download the results of a run");
  fetch->add_option("ID", line.id, "run")->required();
  fetch->add_option("--out", line.out, "folder to put them in")->required();
  add_url(fetch, line);
  fetch->callback([&line] { line.status = fetch_command(line.url, line.id, line.out); });

  add_run_command(app, line, "cancel", "end a run", cancel_command);
  add_run_command(app, line, "log", "what happened in a run", log_command);
  add_run_command(app, line, "delete", "delete a run that has ended, with its files", delete_command);
}

}  // namespace
}  // namespace quicksand

int main(int argc, char** argv) {
  CLI::App app{"quicksand: material point simulation of saturated ground and free water"};
  quicksand::CommandLine line;
  app.set_version_flag("--version", std::string("quicksand ") + quicksand::engine_version +
                                        ", engine build " + quicksand::engine_build());
  app.require_subcommand(1);
  quicksand::add_local_commands(app, line);
  quicksand::add_serve_command(app, line);
  quicksand::add_key_commands(app, line);
  quicksand::add_remote_commands(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? quicksand::exit_status::ok : quicksand::exit_status::bad_input;
  }
  return line.status;
}

#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "api/case_json.hpp"
#include "server/client.hpp"
#include "server/commands.hpp"
#include "server/headline.hpp"
#include "server/progress_bar.hpp"

namespace quicksand {
namespace {

/// Runs `talk` with a client of the server and turns its errors into messages and exit status.
template <typename Talk>
int with_server(const std::string& url, Talk talk) {
  try {
    Client client(url);
    return talk(client);
  } catch (const ClientError& error) {
    if (!error.faults.empty()) {
      print_faults("the case", error.faults);
      return exit_status::bad_input;
    }
    std::cerr << error.message << '\n';
    return error.status == 0 ? exit_status::no_server : exit_status::failed;
  } catch (const nlohmann::json::exception&) {
    std::cerr << url << " does not answer like a quicksand server\n";
    return exit_status::no_server;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return exit_status::not_written;
  }
}

/// The case with another `numerics.preset`, which replaces what else would choose the cells. Requires a case
/// without faults.
std::string with_preset(const std::string& text, Preset preset) {
  Json json = Json::parse(text);
  Json& numerics = json["numerics"];
  numerics["preset"] = preset_name(preset);
  if (!numerics.contains("chosen") || numerics["chosen"].is_null())
    for (const char* key : {"target_error", "budget_seconds"}) numerics.erase(key);
  return json.dump(2);
}

void print_run(const RemoteRun& run) {
  std::cout << run.id << "  " << run.status << "  " << run.json.value("name", "");
  if (const std::string label = run.json.value("label", ""); !label.empty())
    std::cout << "  (" << label << ')';
  std::cout << "  created " << run.json.value("created", "") << '\n';
  if (run.progress && !run.ended()) std::cout << "  " << progress_text(*run.progress) << '\n';
  if (run.json.at("failure").is_object())
    std::cout << "  " << run.json["failure"].value("code", "") << ": "
              << run.json["failure"].value("message", "") << '\n';
}

/// Why a run that had begun waits in the queue; empty when it does not.
std::string waits_for(const RemoteRun& run) {
  if (run.ended() || !run.json.at("failure").is_object()) return "";
  return "waits (" + run.json["failure"].value("code", "") + "): " + run.json["failure"].value("message", "");
}

int print_end(Client& client, const RemoteRun& run) {
  if (run.json.at("failure").is_object())
    std::cerr << "failed (" << run.json["failure"].value("code", "")
              << "): " << run.json["failure"].value("message", "") << '\n';
  for (const StoredResult& result : client.results(run.id))
    if (result.name == "tradeoff.csv")
      std::cout << client.result_text(run.id, result.name);
    else if (result.name == "run.json" && run.json.value("kind", "run") == "run")
      std::cout << headline_text(client.result_text(run.id, result.name));
  std::cout << "Files: quicksand fetch " << run.id << " --out DIR\n";
  return run.status == "succeeded" ? exit_status::ok : exit_status::failed;
}

}  // namespace

int submit_command(const SubmitCommand& command) {
  auto text = read_case_file(command.case_file);
  if (!text) return exit_status::bad_input;
  if (command.preset) {
    const ParsedCase parsed = parse_case(*text, command.preset);
    if (!parsed.scene) {
      print_faults(command.case_file, parsed.faults);
      return exit_status::bad_input;
    }
    text = with_preset(*text, *command.preset);
  }
  return with_server(command.url, [&](Client& client) {
    RemoteRun run = client.submit(*text, {command.label, command.priority, command.tradeoff, command.budget});
    std::cout << run.id << std::endl;
    if (!command.wait) return exit_status::ok;
    {
      ProgressBar bar;
      std::string told;
      run = client.wait(run.id, [&](const RemoteRun& now) {
        if (now.progress) bar.draw(*now.progress);
        const std::string reason = waits_for(now);
        if (!reason.empty() && reason != told) std::cerr << reason << '\n';
        told = reason;
      });
      bar.finish();
    }
    return print_end(client, run);
  });
}

int status_command(const std::string& url, const std::string& id) {
  return with_server(url, [&](Client& client) {
    if (!id.empty()) {
      print_run(client.find(id));
      return exit_status::ok;
    }
    for (const RemoteRun& run : client.list()) print_run(run);
    return exit_status::ok;
  });
}

int fetch_command(const std::string& url, const std::string& id, const std::string& out) {
  return with_server(url, [&](Client& client) {
    const RemoteRun run = client.find(id);
    if (!run.ended()) {
      std::cerr << "run " << id << " is still " << run.status << '\n';
      return exit_status::failed;
    }
    std::filesystem::create_directories(out);
    for (const StoredResult& result : client.results(id)) {
      client.download(id, result, out);
      std::cout << (std::filesystem::path(out) / result.name).string() << "  " << result.bytes << " bytes\n";
    }
    std::cout << files_text(out);
    return exit_status::ok;
  });
}

int log_command(const std::string& url, const std::string& id) {
  return with_server(url, [&](Client& client) {
    std::cout << client.log(id);
    return exit_status::ok;
  });
}

int delete_command(const std::string& url, const std::string& id) {
  return with_server(url, [&](Client& client) {
    client.remove(id);
    return exit_status::ok;
  });
}

int cancel_command(const std::string& url, const std::string& id) {
  return with_server(url, [&](Client& client) {
    print_run(client.cancel(id));
    return exit_status::ok;
  });
}

}  // namespace quicksand

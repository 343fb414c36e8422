#include "server/client.hpp"

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "server/sha256.hpp"

namespace quicksand {
namespace {

constexpr int connect_timeout_s = 5, answer_timeout_s = 60;
/// Seconds of one long poll; far below `answer_timeout_s`.
constexpr const char* poll_preference = "wait=10";

std::optional<Progress> read_progress(const Json& json) {
  if (json.is_null()) return {};
  Progress progress;
  progress.fraction = json.value("fraction", 0.0);
  progress.stage = json.value("stage", "");
  progress.sim_time = json.value("sim_time", 0.0);
  progress.end_time = json.value("end_time", 0.0);
  progress.step = json.value("step", 0L);
  progress.time_step = json.value("time_step", 0.0);
  progress.bound = json.value("bound", "");
  progress.frames = json.value("frames", std::size_t{0});
  progress.eta_s = json.value("eta_s", 0.0);
  return progress;
}

RemoteRun remote_run(const Json& json) {
  RemoteRun run;
  run.json = json;
  run.id = json.at("id");
  run.status = json.at("status");
  run.progress = read_progress(json.at("progress"));
  return run;
}

/// What a problem document says, for people.
ClientError problem_of(const httplib::Response& response) {
  ClientError error{response.status, "HTTP " + std::to_string(response.status), {}};
  const Json json = Json::parse(response.body, nullptr, false);
  if (!json.is_object()) return error;
  error.message = json.value("title", error.message);
  if (json.contains("detail")) error.message += ": " + json.value("detail", "");
  for (const Json& fault : json.value("errors", Json::array()))
    error.faults.push_back({fault.value("pointer", ""), fault.value("detail", "")});
  return error;
}

/// Bytes of the file on disk; 0 when there is none.
std::uintmax_t bytes_there(const std::filesystem::path& file) {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(file, none);
  return none ? 0 : bytes;
}

}  // namespace

Client::Client(const std::string& url) : url_(url), http_(url) {
  if (!http_.is_valid()) throw ClientError{0, "not a server address: " + url, {}};
  std::signal(SIGPIPE, SIG_IGN);
  http_.set_connection_timeout(connect_timeout_s);
  http_.set_read_timeout(answer_timeout_s);
  if (const char* key = std::getenv("QUICKSAND_KEY"))  // not an option: others see a process's command line
    http_.set_default_headers({{"Authorization", std::string("Bearer ") + key}});
}

httplib::Result Client::checked(httplib::Result result) const {
  if (!result) throw ClientError{0, "no answer from " + url_ + " (" + to_string(result.error()) + ")", {}};
  if (result->status >= 400) throw problem_of(*result);
  return result;
}

RemoteRun Client::read_run(const httplib::Response& response) const {
  const Json json = Json::parse(response.body, nullptr, false);
  if (!json.is_object() || !json.contains("id"))
    throw ClientError{response.status, url_ + " does not answer like a quicksand server", {}};
  RemoteRun run = remote_run(json);
  run.etag = response.get_header_value("ETag");
  return run;
}

RemoteRun Client::submit(const std::string& case_text, const Order& order) {
  httplib::Params params{{"priority", std::to_string(order.priority)}};
  if (!order.label.empty()) params.emplace("label", order.label);
  if (order.tradeoff) params.emplace("kind", "tradeoff");
  if (order.budget) params.emplace("budget", std::to_string(*order.budget));
  const std::string path = httplib::append_query_params("/v1/runs", params);
  return read_run(*checked(http_.Post(path, case_text, "application/json")));
}

RemoteRun Client::find(const std::string& id) { return read_run(*checked(http_.Get("/v1/runs/" + id))); }

std::vector<RemoteRun> Client::list() {
  const auto result = checked(http_.Get("/v1/runs"));
  std::vector<RemoteRun> runs;
  const Json json = Json::parse(result->body, nullptr, false);
  if (json.is_object())
    for (const Json& run : json.value("runs", Json::array())) runs.push_back(remote_run(run));
  return runs;
}

RemoteRun Client::cancel(const std::string& id) {
  return read_run(*checked(http_.Post("/v1/runs/" + id + "/cancel", "", "application/json")));
}

void Client::remove(const std::string& id) { checked(http_.Delete("/v1/runs/" + id)); }

std::string Client::log(const std::string& id) { return checked(http_.Get("/v1/runs/" + id + "/log"))->body; }

RemoteRun Client::wait(const std::string& id, const std::function<void(const RemoteRun&)>& show) {
  RemoteRun run = find(id);
  show(run);
  while (!run.ended()) {
    const auto answer = checked(http_.Get(
        "/v1/runs/" + id, httplib::Headers{{"Prefer", poll_preference}, {"If-None-Match", run.etag}}));
    if (answer->status == 304) continue;
    run = read_run(*answer);
    show(run);
  }
  return run;
}

std::vector<StoredResult> Client::results(const std::string& id) {
  const auto answer = checked(http_.Get("/v1/runs/" + id + "/results"));
  std::vector<StoredResult> results;
  const Json json = Json::parse(answer->body);
  for (const Json& result : json.at("results"))
    results.push_back({result.at("name"), result.at("bytes"), result.at("sha256")});
  return results;
}

std::string Client::result_text(const std::string& id, const std::string& name) {
  return checked(http_.Get("/v1/runs/" + id + "/results/" + name))->body;
}

void Client::download(const std::string& id, const StoredResult& result,
                      const std::filesystem::path& folder) {
  if (result.name.find('/') != std::string::npos || result.name.starts_with('.'))
    throw ClientError{0, "refused to write a file called " + result.name, {}};
  const auto file = folder / result.name, part = folder / (result.name + ".part");
  if (bytes_there(file) == result.bytes && sha256_file(file) == result.sha256) return;
  if (bytes_there(part) > result.bytes) std::filesystem::remove(part);
  if (bytes_there(part) < result.bytes || result.bytes == 0) fetch_rest(id, result, part);
  if (sha256_file(part) != result.sha256) {
    std::filesystem::remove(part);
    throw ClientError{0, result.name + " arrived damaged (SHA-256 differs); fetch it again", {}};
  }
  std::filesystem::rename(part, file);
}

void Client::fetch_rest(const std::string& id, const StoredResult& result,
                        const std::filesystem::path& part) {
  const auto have = bytes_there(part);
  httplib::Headers headers;
  if (have > 0)
    headers = {{"Range", "bytes=" + std::to_string(have) + "-"}, {"If-Range", '"' + result.sha256 + '"'}};
  std::ofstream out;
  std::string refusal;  // the body of an error, which the receiver takes from the response
  bool refused = false;
  auto answer = http_.Get(
      "/v1/runs/" + id + "/results/" + result.name, headers,
      [&](const httplib::Response& response) {
        refused = response.status >= 400;
        if (!refused)
          out.open(part, std::ios::binary | (response.status == 206 ? std::ios::app : std::ios::trunc));
        return true;
      },
      [&](const char* bytes, std::size_t count) {
        if (refused)
          refusal.append(bytes, count);
        else
          out.write(bytes, static_cast<std::streamsize>(count));
        return bool(out);
      });
  if (refused && answer) answer->body = refusal;
  if (!refused) out.close();
  if (!out) throw std::runtime_error("cannot write " + part.string());
  checked(std::move(answer));
}

}  // namespace quicksand

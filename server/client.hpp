#pragma once
#include <httplib.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "engine/scene/scene.hpp"
#include "server/run_json.hpp"
#include "server/store.hpp"

namespace quicksand {

/// The server said no, or was not there.
struct ClientError {
  int status = 0;  ///< HTTP status; 0: no answer
  std::string message;
  std::vector<Fault> faults;
};

/// What a server answers about a run.
struct RemoteRun {
  Json json;
  std::string id, status, etag;
  std::optional<Progress> progress;
  bool ended() const { return status == "succeeded" || status == "failed" || status == "canceled"; }
};

/// Talks to a quicksand server. All members throw ClientError.
class Client {
 public:
  explicit Client(const std::string& url);

  struct Order {
    std::string label;
    int priority = 0;
    bool tradeoff = false;
    std::optional<int> budget;  ///< s, of a tradeoff
  };
  RemoteRun submit(const std::string& case_text, const Order& order);
  RemoteRun find(const std::string& id);
  std::vector<RemoteRun> list();
  RemoteRun cancel(const std::string& id);
  /// Deletes an ended run with its files.
  void remove(const std::string& id);
  /// What happened in the run, line by line.
  std::string log(const std::string& id);
  /// Waits for the run's end; `show` sees every progress.
  RemoteRun wait(const std::string& id, const std::function<void(const RemoteRun&)>& show);
  std::vector<StoredResult> results(const std::string& id);
  /// Text of a small result, e.g. run.json.
  std::string result_text(const std::string& id, const std::string& name);
  /// Saves a result as `folder/name`. Continues a `.part` left by an earlier try and checks the SHA-256.
  /// Throws std::runtime_error when it cannot be written.
  void download(const std::string& id, const StoredResult& result, const std::filesystem::path& folder);

 private:
  void fetch_rest(const std::string& id, const StoredResult& result, const std::filesystem::path& part);
  httplib::Result checked(httplib::Result result) const;
  RemoteRun read_run(const httplib::Response& response) const;

  std::string url_;
  httplib::Client http_;
};

}  // namespace quicksand

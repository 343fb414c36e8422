// Server-Sent Events: the run's record whenever it changes.

#include <charconv>
#include <chrono>

#include "server/http_problem.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"

namespace quicksand {
namespace {

using Steady = std::chrono::steady_clock;

/// Between two signs of life on a silent stream; proxies give up after a minute.
constexpr std::chrono::seconds heartbeat{15};
constexpr int full_streams_retry_s = 10;  ///< s, `Retry-After` when all streams are taken

struct Stream {
  Service& service;
  std::string id;
  long long seen;  ///< revision that the client knows
  std::shared_ptr<void> place;
  Steady::time_point next_beat = Steady::now() + heartbeat;

  bool write(httplib::DataSink& sink, const std::string& text) {
    next_beat = Steady::now() + heartbeat;
    return sink.write(text.data(), text.size());
  }

  /// Sends the next event or heartbeat, waiting for it. False when the client is gone.
  bool advance(httplib::DataSink& sink) {
    const long long mark = service.bell.mark();
    const auto run = service.store.find(id);
    if (run && run->revision > seen) {
      seen = run->revision;
      if (!write(sink, "id: " + std::to_string(seen) +
                           "\nevent: run\ndata: " + dump(run_json(*run, service.settings)) + "\n\n"))
        return false;
    }
    if (!run || !is_active(run->state) || service.stopping) {
      sink.done();
      return true;
    }
    service.bell.wait_after(mark, next_beat);
    return Steady::now() < next_beat || write(sink, ": still here\n\n");
  }
};

/// Revision after which to go on; 0 for all.
long long last_event(const httplib::Request& request) {
  const std::string text = request.get_header_value("Last-Event-ID");
  long long revision = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), revision);
  if (!text.empty() && (error != std::errc{} || end != text.data() + text.size() || revision < 0))
    fail(400, "Last-Event-ID: the id of an event of this stream, a whole number");
  return revision;
}

}  // namespace

void get_run_events(Service& service, const Call& call, httplib::Response& response) {
  const StoredRun run = run_of(service, call);
  const long long seen = last_event(call.request);
  if (!is_active(run.state) && run.revision <= seen) {  // tells the client not to connect again
    response.status = 204;
    return;
  }
  auto place = service.streams.take();
  if (!place)
    throw ProblemError{{503,
                        "all event streams are taken: " +
                            named_limit(service.settings, &Settings::max_streams) + "; poll instead",
                        {},
                        {},
                        full_streams_retry_s}};
  response.set_header("Cache-Control", "no-store");
  response.set_header("X-Accel-Buffering", "no");
  auto stream = std::make_shared<Stream>(Stream{service, run.id, seen, std::move(place)});
  response.set_content_provider(
      "text/event-stream", [stream](std::size_t, httplib::DataSink& sink) { return stream->advance(sink); });
}

}  // namespace quicksand

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>

#include "server/http_problem.hpp"
#include "server/http_range.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"

namespace quicksand {
namespace {

/// Seconds of `Prefer: wait=N` (RFC 7240), at most `most`; empty when not asked for.
std::optional<int> preferred_wait(const httplib::Request& request, int most) {
  const std::string prefer = request.get_header_value("Prefer");
  const auto at = prefer.find("wait=");
  if (at == std::string::npos) return {};
  unsigned seconds = 0;
  const auto digits = prefer.data() + at + 5;
  if (std::from_chars(digits, prefer.data() + prefer.size(), seconds).ec != std::errc{}) return {};
  return static_cast<int>(std::min(seconds, static_cast<unsigned>(most)));
}

std::string weak_etag(const StoredRun& run) {
  return "W/\"" + run.id + "-" + std::to_string(run.revision) + "\"";
}

/// Waits until the client would learn something: with If-None-Match any change of the record, without it
/// the end of the run.
StoredRun wait_for_news(Service& service, const Call& call, int seconds) {
  const std::string known = call.request.get_header_value("If-None-Match");
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  for (;;) {
    const long long mark = service.bell.mark();
    const StoredRun run = run_of(service, call);
    const bool news =
        known.empty() ? !is_active(run.state) : !etag_matches(known, weak_etag(run), EtagComparison::weak);
    if (news || !service.bell.wait_after(mark, deadline)) return run;
  }
}

}  // namespace

void get_run(Service& service, const Call& call, httplib::Response& response) {
  const auto wait = preferred_wait(call.request, static_cast<int>(service.settings.max_wait_s));
  StoredRun run = run_of(service, call);
  if (const auto place = wait ? service.waiters.take() : nullptr) {
    run = wait_for_news(service, call, *wait);
    response.set_header("Preference-Applied", "wait=" + std::to_string(*wait));
  }
  const std::string etag = weak_etag(run);
  response.set_header("ETag", etag);
  response.set_header("Cache-Control", "no-cache");
  if (call.request.has_header("If-None-Match") &&
      etag_matches(call.request.get_header_value("If-None-Match"), etag, EtagComparison::weak)) {
    response.status = 304;
    return;
  }
  response.set_content(dump(run_json(run, service.settings)), "application/json");
}

}  // namespace quicksand

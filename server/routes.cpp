#include "server/routes.hpp"

#include <SQLiteCpp/Exception.h>
#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "server/cors.hpp"
#include "server/http_problem.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"

namespace quicksand {

const std::vector<Route>& route_table() {
  static const std::vector<Route> table{
      {"POST", "/v1/runs", post_run, Access::change, {"label", "priority", "kind", "budget"}, true},
      {"GET",
       "/v1/runs",
       get_runs,
       Access::known,
       {"status", "label", "name_prefix", "created_after", "limit", "page_token"}},
      {"GET", "/v1/runs/{id}", get_run, Access::known, {}},
      {"DELETE", "/v1/runs/{id}", delete_run, Access::change, {}},
      {"POST", "/v1/runs/{id}/cancel", post_cancel, Access::change, {}},
      {"GET", "/v1/runs/{id}/case", get_run_case, Access::known, {}},
      {"GET", "/v1/runs/{id}/log", get_run_log, Access::known, {}},
      {"GET", "/v1/runs/{id}/events", get_run_events, Access::known, {}},
      {"GET", "/v1/runs/{id}/series", get_series, Access::known, {"name", "format"}},
      {"GET", "/v1/runs/{id}/frames/{k}", get_frame, Access::known, {"fields", "stride"}},
      {"GET", "/v1/runs/{id}/results", get_results, Access::known, {}},
      {"GET", "/v1/runs/{id}/results/{file}", get_result_file, Access::known, {}},
      {"POST", "/v1/validate", post_validate, Access::known, {"trial"}, true},
      {"GET", "/v1/cases", get_cases, Access::known, {}},
      {"GET", "/v1/cases/{name}", get_case, Access::known, {}},
      {"GET", "/v1/schemas/case", get_case_schema, Access::known, {}},
      {"GET", "/v1/openapi.yaml", get_openapi, Access::known, {}},
      {"GET", "/v1/service-info", get_service_info, Access::known, {}},
      {"GET", "/healthz", get_healthz, Access::anyone, {}},
      {"GET", "/readyz", get_readyz, Access::anyone, {}},
      {"GET", "/metrics", get_metrics, Access::observe, {}},
  };
  return table;
}

namespace {

std::vector<std::string> segments(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t begin = 1; begin <= path.size();) {
    const auto slash = std::min(path.find('/', begin), path.size());
    parts.push_back(path.substr(begin, slash - begin));
    begin = slash + 1;
  }
  return parts;
}

/// Whether `path` has the form of `pattern`; then `captured` holds its variable segments.
bool matches(const std::string& pattern, const std::string& path, std::vector<std::string>& captured) {
  const auto wanted = segments(pattern), given = segments(path);
  if (wanted.size() != given.size()) return false;
  captured.clear();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].front() == '{' && !given[i].empty())
      captured.push_back(given[i]);
    else if (wanted[i] != given[i])
      return false;
  }
  return true;
}

bool same_method(const std::string& route, const std::string& method) {
  return route == method || (route == "GET" && method == "HEAD");
}

/// An input without effect is an error, and so is one given twice.
void refuse_unknown_parameters(const Route& route, const httplib::Request& request) {
  const auto& known = route.parameters;
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  for (const auto& [name, value] : request.params) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail(400, "unknown query parameter \"" + name + "\"; known here: " + (list.empty() ? "none" : list));
    if (request.get_param_value_count(name) > 1) fail(400, "query parameter \"" + name + "\" is given twice");
  }
}

/// What the store refuses, without its words: they may hold paths.
Problem database_problem(const SQLite::Exception& error) {
  constexpr int broken_retry_s = 10;
  spdlog::error("store: {}", error.what());
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      return {507, "no space left for the run's record", {}, {}, 0};
    case SQLITE_BUSY:
      return {503, "the store is busy", {}, {}, 1};
    case SQLITE_READONLY:
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
      return {503, "the store cannot be used", {}, {}, broken_retry_s};
    default:
      return {};
  }
}

/// Long polls and streams are held on purpose and would hide how fast the rest is.
void count_answer(Service& service, const httplib::Request& request, const httplib::Response& response,
                  std::chrono::steady_clock::duration duration) {
  if (response.has_header("Preference-Applied")) return;
  const RouteMatch match = find_route(request.method, request.path);
  const char* route = match.route ? match.route->pattern : "none";
  const char* method = match.route ? match.route->method : "other";
  service.metrics.answered(method, route, response.status == -1 ? 200 : response.status,
                           std::chrono::duration<double>(duration).count());
}

void call_route(Service& service, const httplib::Request& request, httplib::Response& response) {
  if (answer_preflight(service.settings, request, response)) return;
  RouteMatch match = find_route(request.method, request.path);
  if (!match.route && match.allow.empty()) fail(404, "nothing at " + request.path);
  if (!match.route) throw ProblemError{{405, request.method + " is not possible here", {}, match.allow, 0}};
  const Caller caller = admit(service.keys, service.settings, request, match.route->access);
  refuse_unknown_parameters(*match.route, request);
  match.route->handler(service, Call{request, std::move(match.captured), caller}, response);
}

}  // namespace

RouteMatch find_route(const std::string& method, const std::string& path) {
  RouteMatch match;
  std::set<std::string> allowed;
  for (const Route& route : route_table()) {
    if (!matches(route.pattern, path, match.captured)) continue;
    if (same_method(route.method, method)) {
      match.route = &route;
      return match;
    }
    allowed.insert(route.method);
    if (route.method == std::string("GET")) allowed.insert("HEAD");
  }
  for (const std::string& name : allowed) match.allow += (match.allow.empty() ? "" : ", ") + name;
  return match;
}

std::optional<Problem> screen_caller(Service& service, const httplib::Request& request) {
  const RouteMatch match = find_route(request.method, request.path);
  try {
    if (match.route) admit(service.keys, service.settings, request, match.route->access);
  } catch (const ProblemError& error) {
    return error.problem;
  } catch (const SQLite::Exception& error) {
    return database_problem(error);
  }
  return {};
}

void dispatch(Service& service, const httplib::Request& request, httplib::Response& response) {
  const auto begin = std::chrono::steady_clock::now();
  try {
    call_route(service, request, response);
  } catch (const ProblemError& error) {
    answer(response, error.problem);
  } catch (const SQLite::Exception& error) {
    answer(response, database_problem(error));
  } catch (const std::exception& error) {  // its text stays on our side
    spdlog::error("http method={} path={} error={}", quoted(request.method), quoted(request.path),
                  quoted(error.what()));
    answer(response, Problem{});
  }
  count_answer(service, request, response, std::chrono::steady_clock::now() - begin);
}

}  // namespace quicksand

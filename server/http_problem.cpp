#include "server/http_problem.hpp"

#include "server/run_json.hpp"

namespace quicksand {
namespace {

const char* title(int status) {
  switch (status) {
    case 400:
      return "Bad request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not found";
    case 405:
      return "Method not allowed";
    case 409:
      return "Conflict";
    case 410:
      return "Gone";
    case 411:
      return "Length required";
    case 413:
      return "Content too large";
    case 414:
      return "URI too long";
    case 415:
      return "Unsupported media type";
    case 416:
      return "Range not satisfiable";
    case 422:
      return "Unprocessable content";
    case 421:
      return "Misdirected request";
    case 429:
      return "Too many requests";
    case 503:
      return "Service unavailable";
    case 507:
      return "Insufficient storage";
    default:
      return status < 500 ? "Bad request" : "Internal error";
  }
}

}  // namespace

void fail(int status, const std::string& detail) {
  Problem problem;
  problem.status = status;
  problem.detail = detail;
  throw ProblemError{problem};
}

std::string problem_json(const Problem& problem) {
  Json json{{"type", "about:blank"}, {"title", title(problem.status)}, {"status", problem.status}};
  if (!problem.detail.empty()) json["detail"] = problem.detail;
  if (!problem.errors.empty()) {
    json["errors"] = Json::array();
    for (const Fault& fault : problem.errors)
      json["errors"].push_back({{"pointer", fault.pointer}, {"detail", fault.detail}});
  }
  return dump(json);
}

void answer(httplib::Response& response, const Problem& problem) {
  response.status = problem.status;
  if (problem.status == 401) response.set_header("WWW-Authenticate", "Bearer realm=\"quicksand\"");
  if (!problem.allow.empty()) response.set_header("Allow", problem.allow);
  if (problem.retry_after_s > 0) response.set_header("Retry-After", std::to_string(problem.retry_after_s));
  response.set_content(problem_json(problem), "application/problem+json");
}

}  // namespace quicksand

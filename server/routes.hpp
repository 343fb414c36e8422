#pragma once
#include <optional>
#include <string>
#include <vector>

#include "server/http_problem.hpp"
#include "server/service.hpp"

namespace quicksand {

struct Route {
  const char* method;   ///< GET answers HEAD as well
  const char* pattern;  ///< `{name}` stands for one path segment
  RouteHandler handler;
  Access access;
  std::vector<std::string> parameters;  ///< the query parameters it understands; others are refused
  bool takes_case = false;              ///< the body is a case, as JSON
};

/// Everything the server answers, in one place.
const std::vector<Route>& route_table();

/// The route of a request, or why there is none (404, or 405 with Allow).
struct RouteMatch {
  const Route* route = nullptr;
  std::vector<std::string> captured;
  std::string allow;  ///< not empty: the path exists for these methods only
};
RouteMatch find_route(const std::string& method, const std::string& path);

/// Why the caller may not have what it asks for, to be asked before its body is read. Empty when it may.
std::optional<Problem> screen_caller(Service& service, const httplib::Request& request);

/// Calls the route's handler and turns whatever goes wrong into a problem. Never throws.
void dispatch(Service& service, const httplib::Request& request, httplib::Response& response);

}  // namespace quicksand

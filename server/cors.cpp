#include "server/cors.hpp"

#include "server/routes.hpp"

namespace quicksand {
namespace {

bool from_the_allowed_site(const Settings& settings, const httplib::Request& request) {
  return !settings.cors_origin.empty() && request.get_header_value("Origin") == settings.cors_origin;
}

}  // namespace

bool answer_preflight(const Settings& settings, const httplib::Request& request,
                      httplib::Response& response) {
  if (request.method != "OPTIONS" || !request.has_header("Access-Control-Request-Method")) return false;
  const std::string allow = find_route("OPTIONS", request.path).allow;
  if (!from_the_allowed_site(settings, request) || allow.empty()) return false;
  response.status = 204;
  response.set_header("Access-Control-Allow-Methods", allow);
  response.set_header("Access-Control-Allow-Headers",
                      "Authorization, Content-Type, Idempotency-Key, If-None-Match, If-Range, Last-Event-ID, "
                      "Prefer, Range, X-API-Key");
  response.set_header("Access-Control-Max-Age", "600");
  return true;
}

void add_cors_headers(const Settings& settings, const httplib::Request& request,
                      httplib::Response& response) {
  if (settings.cors_origin.empty()) return;
  response.set_header("Vary", "Origin");
  if (!from_the_allowed_site(settings, request)) return;
  response.set_header("Access-Control-Allow-Origin", settings.cors_origin);
  response.set_header("Access-Control-Expose-Headers",
                      "Content-Range, ETag, Location, Preference-Applied, Retry-After");
}

}  // namespace quicksand

#include "server/http_server.hpp"

#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <charconv>
#include <stdexcept>

#include "server/cors.hpp"
#include "server/routes.hpp"
#include "server/run_json.hpp"

namespace quicksand {
namespace {

/// Connections served at a time, besides those that long polls, event streams, data and downloads may hold.
constexpr Count connection_threads = 64;
constexpr int first_port = 8080, last_port = 8179;
/// s without a byte before a connection is given up. Who reads slowly holds a place of his own kind only, and
/// may pause as long as nginx lets him (send_timeout).
constexpr int read_timeout_s = 5, write_timeout_s = 35;

/// Connections that may wait to be accepted.
constexpr int backlog = 128;

Problem refusal(int status, const std::string& detail) {
  Problem problem;
  problem.status = status;
  problem.detail = detail;
  return problem;
}

/// Value of Content-Length when there is exactly one and it is a number; 0 when absent; empty otherwise.
std::optional<std::uint64_t> content_length(const httplib::Request& request) {
  const auto count = request.get_header_value_count("Content-Length");
  if (count == 0) return 0;
  const std::string text = request.get_header_value("Content-Length");
  std::uint64_t length = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (count > 1 || error != std::errc{} || end != text.data() + text.size()) return {};
  return length;
}

bool is_json(const std::string& type) {
  const std::string essence = type.substr(0, type.find_first_of("; "));
  return essence == "application/json";
}

/// The library applies Range by itself, to every answer and past the end. We answer ranges ourselves, so it
/// must not see them. The request is the library's own object, created non-const for this connection.
void hide_ranges(const httplib::Request& request) { const_cast<httplib::Request&>(request).ranges.clear(); }

/// The service sends data, never a page: nothing in it may run, be framed or be read by other sites.
void add_security_headers(httplib::Response& response) {
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  response.set_header("Referrer-Policy", "no-referrer");
  if (!response.has_header("Cache-Control")) response.set_header("Cache-Control", "private, no-cache");
}

void log_answer(const httplib::Request& request, const httplib::Response& response) {
  const bool routine = request.method == "GET" && response.status < 400;
  spdlog::log(routine ? spdlog::level::debug : spdlog::level::info, "http method={} path={} status={}",
              quoted(request.method), quoted(request.path), response.status);
}

}  // namespace

std::optional<Problem> screen_request(const httplib::Request& request, const Settings& settings) {
  if (request.has_header("Transfer-Encoding"))
    return refusal(411, "send Content-Length instead of Transfer-Encoding");
  if (request.has_header("Content-Encoding")) return refusal(415, "send the body without Content-Encoding");
  if (request.version == "HTTP/1.1" && request.get_header_value_count("Host") != 1)
    return refusal(400, "one Host header is needed");
  const auto length = content_length(request);
  if (!length) return refusal(400, "Content-Length must be one whole number");
  if (*length > static_cast<std::uint64_t>(settings.max_body_bytes))
    return refusal(413, "a body of " + std::to_string(*length) + " bytes; at most " +
                            named_limit(settings, &Settings::max_body_bytes));
  const RouteMatch match = find_route(request.method, request.path);
  if (match.route && match.route->takes_case) {
    if (!request.has_header("Content-Length")) return refusal(411, "Content-Length is missing");
    if (request.get_header_value_count("Content-Type") != 1 ||
        !is_json(request.get_header_value("Content-Type")))
      return refusal(415, "send the case with Content-Type: application/json");
  }
  return {};
}

std::optional<Problem> HttpServer::screen(const httplib::Request& request) {
  if (auto refused = screen_request(request, service_.settings)) return refused;
  return screen_caller(service_, request);
}

void PatientServer::widen_backlog() { ::listen(svr_sock_, backlog); }

HttpServer::HttpServer(Service& service) : service_(service) {
  install_limits();
  install_handlers();
}

void HttpServer::install_limits() {
  http_.set_keep_alive_max_count(1);  // an idle client must not hold a thread
  const Settings& s = service_.settings;
  const auto threads = static_cast<std::size_t>(connection_threads + s.max_waiters + s.max_streams +
                                                s.max_readers + s.max_downloads + s.max_trials);
  http_.new_task_queue = [threads] { return new httplib::ThreadPool(threads); };
  http_.set_read_timeout(read_timeout_s);
  http_.set_write_timeout(write_timeout_s);
  http_.set_payload_max_length(static_cast<std::size_t>(service_.settings.max_body_bytes));
  http_.set_tcp_nodelay(true);
  // Not the library's default, SO_REUSEPORT: with it two servers would share a port.
  http_.set_socket_options([](socket_t socket) {
    const int on = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  });
}

void HttpServer::install_handlers() {
  using Handled = httplib::Server::HandlerResponse;
  http_.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    hide_ranges(request);
    if (const auto refused = screen(request)) {
      answer(response, *refused);
      return Handled::Handled;
    }
    // A body has to be read first, which the library does on its way to the handler below. Without one it
    // would wait for the end of the connection.
    if (request.method == "POST" && content_length(request).value_or(0) > 0) return Handled::Unhandled;
    dispatch(service_, request, response);
    return Handled::Handled;
  });
  http_.Post("/.*", [this](const httplib::Request& request, httplib::Response& response) {
    dispatch(service_, request, response);
  });
  http_.set_expect_100_continue_handler([this](const httplib::Request& request, httplib::Response& response) {
    const auto refused = screen(request);
    if (!refused) return 100;
    answer(response, *refused);
    return refused->status;
  });
  using ErrorHandler = httplib::Server::HandlerWithResponse;  // the library overloads on the return type
  http_.set_error_handler(ErrorHandler([](const httplib::Request& request, httplib::Response& response) {
    hide_ranges(request);
    if (response.body.empty()) answer(response, refusal(response.status, ""));
    return Handled::Handled;
  }));
  http_.set_exception_handler(
      [](const httplib::Request& request, httplib::Response& response, std::exception_ptr) {
        spdlog::error("http method={} path={} exception", quoted(request.method), quoted(request.path));
        answer(response, Problem{});
      });
  http_.set_post_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (response.status == 204) response.headers.erase("Content-Length");
    add_security_headers(response);
    add_cors_headers(service_.settings, request, response);
  });
  http_.set_logger(log_answer);
}

int HttpServer::bind(const std::string& host, int port) {
  const int first = port != 0 ? port : first_port, last = port != 0 ? port : last_port;
  for (int candidate = first; candidate <= last; ++candidate)
    if (http_.bind_to_port(host, candidate)) {
      http_.widen_backlog();
      return candidate;
    }
  if (port != 0) throw std::runtime_error("port " + std::to_string(port) + " on " + host + " is not free");
  throw std::runtime_error("no free port from " + std::to_string(first) + " to " + std::to_string(last));
}

void HttpServer::serve() { http_.listen_after_bind(); }

void HttpServer::stop() { http_.stop(); }

}  // namespace quicksand

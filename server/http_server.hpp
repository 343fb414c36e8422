#pragma once
#include <httplib.h>

#include <optional>
#include <string>

#include "server/http_problem.hpp"
#include "server/service.hpp"

namespace quicksand {

/// Why a request is refused before its body is read or its route looked up: framing that the library would
/// accept but that hides its true length (Transfer-Encoding 411, Content-Encoding 415, odd Content-Length
/// 400), too large (413), not JSON where a case is wanted (415). Empty when it may pass.
std::optional<Problem> screen_request(const httplib::Request& request, const Settings& settings);

/// The library's server, whose queue of connections not yet accepted is widened: its own holds five, and a
/// sixth client at the same moment would wait a second for its system to try again.
class PatientServer : public httplib::Server {
 public:
  /// After binding.
  void widen_backlog();
  /// Instead of binding: a socket that listens already.
  void adopt(int descriptor) { svr_sock_ = descriptor; }
};

/// The HTTP face of a Service: cpp-httplib with everything closed that it leaves open by itself.
class HttpServer {
 public:
  explicit HttpServer(Service& service);

  /// Binds to `port`, or with 0 to the first free one from 8080. Returns the port. Throws
  /// std::runtime_error when there is none.
  int bind(const std::string& host, int port);
  /// Instead of `bind`: serves a socket that listens already.
  void adopt(int descriptor) { http_.adopt(descriptor); }
  /// Answers until `stop`; returns when every connection has ended.
  void serve();
  /// From any thread.
  void stop();

 private:
  void install_limits();
  void install_handlers();
  std::optional<Problem> screen(const httplib::Request& request);

  Service& service_;
  PatientServer http_;
};

}  // namespace quicksand

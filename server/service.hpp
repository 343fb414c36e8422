#pragma once
// What the routes work on.

#include <httplib.h>

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "server/catalogue.hpp"
#include "server/change_bell.hpp"
#include "server/runner.hpp"
#include "server/state_folder.hpp"
#include "server/store.hpp"

namespace quicksand {

/// Bounds of what one client can ask for; `/v1/service-info` tells them.
struct Limits {
  std::size_t max_body_bytes = 4 << 20;  ///< a case; larger ones get 413
  int max_queued = 1000;                 ///< further runs get 503
  int max_page = 200;                    ///< runs in one answer of the list
  int max_wait_s = 30;                   ///< longest long poll
  int max_waiters = 16;                  ///< long polls at a time; the next is answered at once
};

struct Service {
  Store& store;
  Runner& runner;
  ChangeBell& bell;
  const StateFolder& folder;
  std::map<std::string, ShippedCase> cases;
  RunnerOptions workers;
  Limits limits;
  Milliseconds started = utc_now();
  std::atomic<int> waiters{0};
  std::atomic<bool> stopping{false};
};

/// One request on its way to a handler.
struct Call {
  const httplib::Request& request;
  std::vector<std::string> captured;  ///< what stood in place of the route's `{…}`

  /// Query parameter; empty when absent.
  std::string parameter(const std::string& name) const { return request.get_param_value(name); }
};

using RouteHandler = void (*)(Service&, const Call&, httplib::Response&);

}  // namespace quicksand

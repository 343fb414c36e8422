#pragma once
// What the routes work on.

#include <httplib.h>

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/plan/calibration.hpp"
#include "server/access.hpp"
#include "server/catalogue.hpp"
#include "server/change_bell.hpp"
#include "server/keys.hpp"
#include "server/metrics.hpp"
#include "server/places.hpp"
#include "server/runner.hpp"
#include "server/settings.hpp"
#include "server/state_folder.hpp"
#include "server/store.hpp"

namespace quicksand {

struct Service {
  Store& store;
  KeyStore& keys;
  Runner& runner;
  ChangeBell& bell;
  const StateFolder& folder;
  Metrics& metrics;
  const Settings& settings;
  std::map<std::string, ShippedCase> cases;
  Calibration machine;
  Milliseconds started = utc_now();
  Places waiters{settings.max_waiters}, streams{settings.max_streams}, readers{settings.max_readers},
      downloads{settings.max_downloads}, trials{settings.max_trials};
  std::atomic<bool> stopping{false};
};

/// One request on its way to a handler.
struct Call {
  const httplib::Request& request;
  std::vector<std::string> captured;  ///< what stood in place of the route's `{…}`
  Caller caller;

  /// Query parameter; empty when absent.
  std::string parameter(const std::string& name) const { return request.get_param_value(name); }
};

using RouteHandler = void (*)(Service&, const Call&, httplib::Response&);

}  // namespace quicksand

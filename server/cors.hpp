#pragma once
// Pages of one other site may use the service, when `cors_origin` names it (Fetch standard, CORS protocol).

#include <httplib.h>

#include "server/settings.hpp"

namespace quicksand {

/// Whether this is a browser's question before the request itself; then it is answered.
bool answer_preflight(const Settings& settings, const httplib::Request& request, httplib::Response& response);

/// Tells the browser that the page may read the answer. Does nothing for other sites.
void add_cors_headers(const Settings& settings, const httplib::Request& request, httplib::Response& response);

}  // namespace quicksand

#pragma once
#include "server/settings.hpp"

namespace quicksand {

/// Serves until SIGTERM or SIGINT. Prints the URL and the state folder on one line of standard output.
/// Throws std::runtime_error when it cannot start.
void serve(const Settings& settings);

}  // namespace quicksand

#pragma once
#include "server/settings.hpp"

namespace quicksand {

/// Serves a socket of the service manager, or one of its own, until SIGTERM or SIGINT. Prints the URL and the
/// state folder on one line of standard output. Throws std::runtime_error when it cannot start.
void serve(Settings settings);

}  // namespace quicksand

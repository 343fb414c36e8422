#pragma once
#include <optional>
#include <string>

namespace quicksand {

/// A listening socket that a service manager opened for this process (sd_listen_fds(3)).
struct InheritedSocket {
  int descriptor = -1;
  std::string host;  ///< address, or "unix" for a socket in the file system
  int port = 0;      ///< 0 for such a one
};

/// Empty when there is none. Throws std::runtime_error when there are several.
std::optional<InheritedSocket> inherited_socket();

}  // namespace quicksand

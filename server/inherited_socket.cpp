#include "server/inherited_socket.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace quicksand {
namespace {

constexpr int first_descriptor = 3;  // SD_LISTEN_FDS_START

int number_in_environment(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : 0;
}

}  // namespace

std::optional<InheritedSocket> inherited_socket() {
  if (number_in_environment("LISTEN_PID") != ::getpid()) return {};
  const int count = number_in_environment("LISTEN_FDS");
  if (count == 0) return {};
  if (count > 1) throw std::runtime_error("the service manager gave several sockets: one is served");
  InheritedSocket socket{first_descriptor, "unix", 0};
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (::getsockname(socket.descriptor, reinterpret_cast<sockaddr*>(&name), &size) != 0)
    throw std::runtime_error("the service manager's socket cannot be used");
  if (name.ss_family == AF_INET) {
    const auto& address = reinterpret_cast<const sockaddr_in&>(name);
    socket.host = ::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    socket.port = ntohs(address.sin_port);
  } else if (name.ss_family == AF_INET6) {
    const auto& address = reinterpret_cast<const sockaddr_in6&>(name);
    socket.host = ::inet_ntop(AF_INET6, &address.sin6_addr, text.data(), text.size());
    socket.port = ntohs(address.sin6_port);
  }
  return socket;
}

}  // namespace quicksand

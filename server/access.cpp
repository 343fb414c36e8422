#include "server/access.hpp"

#include "server/http_problem.hpp"

namespace quicksand {
namespace {

/// The key of `Authorization: Bearer …` or `X-API-Key`; empty when there is none.
std::string presented_key(const httplib::Request& request) {
  constexpr std::string_view scheme = "bearer ";
  const std::string header = request.get_header_value("Authorization");
  if (header.empty()) return request.get_header_value("X-API-Key");
  std::string given = header.substr(0, scheme.size());
  for (char& c : given) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return given == scheme ? header.substr(scheme.size()) : "";
}

/// A Host header without its port.
std::string host_name(const std::string& header) {
  if (header.starts_with('[')) return header.substr(1, header.find(']') - 1);
  return header.substr(0, header.find(':'));
}

bool names_this_machine(const std::string& header) {
  const std::string host = host_name(header);
  return host != "unix" && is_loopback(host);
}

bool allowed(Role role, Access access) {
  if (access == Access::change) return role != Role::read;
  if (access == Access::observe) return role != Role::submit;
  return true;
}

}  // namespace

bool is_loopback(const std::string& host) {
  return host == "127.0.0.1" || host == "::1" || host == "localhost" || host == "unix";
}

Caller admit(KeyStore& keys, const Settings& settings, const httplib::Request& request, Access access) {
  if (access == Access::anyone) return {};
  if (is_loopback(settings.host) && !keys.any()) {
    if (request.has_header("Host") && !names_this_machine(request.get_header_value("Host")))
      fail(421, "without API keys the service answers only to 127.0.0.1, [::1] and localhost");
    return {};
  }
  const std::string text = presented_key(request);
  const auto key = keys.find(text);
  if (!key)
    fail(401, text.empty() ? "send an API key: Authorization: Bearer KEY, or X-API-Key: KEY"
                           : "this API key is unknown or revoked");
  if (!allowed(key->role, access))
    fail(403, std::string("a key with the role ") + role_name(key->role) + " may not do this");
  return {key->name, key->role};
}

}  // namespace quicksand

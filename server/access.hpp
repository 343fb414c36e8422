#pragma once
// Who asks, and whether he may.

#include <httplib.h>

#include <string>

#include "server/keys.hpp"
#include "server/settings.hpp"

namespace quicksand {

/// What a route asks of its caller.
enum class Access {
  anyone,   ///< no key needed
  known,    ///< any valid key
  change,   ///< submit or admin
  observe,  ///< read or admin: sees what is not its own
};

struct Caller {
  std::string name;  ///< of the key; empty without keys
  Role role = Role::admin;
  bool sees(const std::string& owner) const { return role != Role::submit || owner == name; }
};

/// The caller of a request, or throws ProblemError: 401 without a valid key, 403 when its role is too small.
/// While no key was ever made, everybody on this machine is an admin; then the request's Host has to name
/// this machine (421), so that a web page of another site cannot reach the service through its visitor's
/// browser.
Caller admit(KeyStore& keys, const Settings& settings, const httplib::Request& request, Access access);

/// An address that only this machine reaches; "unix" stands for a socket in the file system.
bool is_loopback(const std::string& host);

}  // namespace quicksand

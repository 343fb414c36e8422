#pragma once
// API keys: who may do what. The store holds only the SHA-256 of a key's secret.

#include <SQLiteCpp/Database.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/clock.hpp"

namespace quicksand {

enum class Role {
  read,    ///< sees every run, changes nothing
  submit,  ///< submits; sees, cancels and deletes its own runs
  admin,   ///< everything, on every run
};
const char* role_name(Role role);
std::optional<Role> role_from_name(const std::string& name);

struct ApiKey {
  std::string id;    ///< public part, for lists and revoking
  std::string name;  ///< whose; runs belong to it, so a second key of the same name sees the same runs
  Role role = Role::read;
  Milliseconds created = 0;
  std::optional<Milliseconds> revoked;
};

/// Thread-safe. Members throw SQLite::Exception when the disk refuses.
class KeyStore {
 public:
  /// On the database of a Store of the current schema. Throws std::runtime_error for another schema.
  explicit KeyStore(const std::filesystem::path& database, Clock clock = utc_now);

  /// The new key's text, `qs_<id>_<secret>`; it cannot be read back.
  std::string create(const std::string& name, Role role);
  /// False when there is no such key. A key that is revoked stays so and is listed.
  bool revoke(const std::string& id);
  std::vector<ApiKey> list();
  /// The valid key that `text` is. Takes as long for a wrong secret as for the right one.
  std::optional<ApiKey> find(const std::string& text);
  /// Whether there was ever a key: from then on the service wants one, also when all are revoked.
  bool any();

 private:
  std::mutex mutex_;
  SQLite::Database database_;
  Clock clock_;
};

}  // namespace quicksand

#include "server/keys.hpp"

#include <SQLiteCpp/Statement.h>
#include <openssl/crypto.h>

#include <array>

#include "server/random_text.hpp"
#include "server/sha256.hpp"
#include "server/store_schema.hpp"

namespace quicksand {
namespace {

constexpr int busy_timeout_ms = 5000;
constexpr std::size_t id_bytes = 4, secret_bytes = 32;
constexpr const char* prefix = "qs_";
constexpr std::array role_names{"read", "submit", "admin"};

ApiKey read_key(SQLite::Statement& row) {
  ApiKey key{row.getColumn(0).getString(),
             row.getColumn(1).getString(),
             role_from_name(row.getColumn(2).getString()).value(),
             row.getColumn(3).getInt64(),
             {}};
  if (!row.getColumn(4).isNull()) key.revoked = row.getColumn(4).getInt64();
  return key;
}

bool equal_in_constant_time(const std::string& a, const std::string& b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

const char* role_name(Role role) { return role_names[static_cast<std::size_t>(role)]; }

std::optional<Role> role_from_name(const std::string& name) {
  for (std::size_t i = 0; i < role_names.size(); ++i)
    if (name == role_names[i]) return static_cast<Role>(i);
  return {};
}

KeyStore::KeyStore(const std::filesystem::path& database, Clock clock)
    : database_(database.string(), SQLite::OPEN_READWRITE, busy_timeout_ms), clock_(std::move(clock)) {
  require_store_schema(database_);
  database_.exec("PRAGMA synchronous = FULL;");
}

std::string KeyStore::create(const std::string& name, Role role) {
  const std::string id = random_hex(id_bytes), secret = random_hex(secret_bytes);
  const std::lock_guard lock(mutex_);
  SQLite::Statement insert(database_,
                           "INSERT INTO api_keys (id, name, role, sha256, created) VALUES (?, ?, ?, ?, ?)");
  insert.bind(1, id);
  insert.bind(2, name);
  insert.bind(3, role_name(role));
  insert.bind(4, sha256_text(secret));
  insert.bind(5, static_cast<int64_t>(clock_()));
  insert.exec();
  return prefix + id + "_" + secret;
}

bool KeyStore::revoke(const std::string& id) {
  const std::lock_guard lock(mutex_);
  SQLite::Statement set(database_, "UPDATE api_keys SET revoked = COALESCE(revoked, ?) WHERE id = ?");
  set.bind(1, static_cast<int64_t>(clock_()));
  set.bind(2, id);
  return set.exec() > 0;
}

std::vector<ApiKey> KeyStore::list() {
  const std::lock_guard lock(mutex_);
  SQLite::Statement rows(database_,
                         "SELECT id, name, role, created, revoked FROM api_keys ORDER BY created, id");
  std::vector<ApiKey> keys;
  while (rows.executeStep()) keys.push_back(read_key(rows));
  return keys;
}

std::optional<ApiKey> KeyStore::find(const std::string& text) {
  const std::size_t id_end = std::string_view(prefix).size() + 2 * id_bytes;
  if (!text.starts_with(prefix) || text.size() <= id_end || text[id_end] != '_') return {};
  const std::string id = text.substr(id_end - 2 * id_bytes, 2 * id_bytes);
  const std::string sum = sha256_text(text.substr(id_end + 1));
  const std::lock_guard lock(mutex_);
  SQLite::Statement row(database_,
                        "SELECT id, name, role, created, revoked, sha256 FROM api_keys WHERE id = ?");
  row.bind(1, id);
  if (!row.executeStep() || !equal_in_constant_time(sum, row.getColumn(5).getString())) return {};
  ApiKey key = read_key(row);
  if (key.revoked) return {};
  return key;
}

bool KeyStore::any() {
  const std::lock_guard lock(mutex_);
  return database_.execAndGet("SELECT EXISTS (SELECT 1 FROM api_keys)").getInt() != 0;
}

}  // namespace quicksand

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <iostream>

#include "server/commands.hpp"
#include "server/files.hpp"
#include "server/keys.hpp"
#include "server/store.hpp"

namespace quicksand {
namespace {

/// Runs `work` on the keys of a state folder and turns errors into messages. `make`: a folder without records
/// gets them, so that a server can have its keys before its first start.
template <class Work>
int with_keys(const std::string& state, bool make, Work work) {
  try {
    const auto database = std::filesystem::path(state) / "quicksand.db";
    if (!std::filesystem::exists(database)) {
      if (!make) {
        std::cerr << "no records in " << state << ": give the state folder of a server\n";
        return exit_status::bad_input;
      }
      make_private();
      std::filesystem::create_directories(state);
      const Store store(database);
    }
    KeyStore keys(database);
    return work(keys);
  } catch (const std::exception& error) {
    std::cerr << "the records in " << state << ": " << error.what() << '\n';
    return exit_status::failed;
  }
}

}  // namespace

int create_key_command(const std::string& state, const std::string& name, const std::string& role) {
  constexpr std::size_t longest_name = 64;
  const auto known = role_from_name(role);
  if (!known || name.empty() || name.size() > longest_name) {
    std::cerr << "a name of 1 to " << longest_name << " bytes and a role read, submit or admin\n";
    return exit_status::bad_input;
  }
  return with_keys(state, true, [&](KeyStore& keys) {
    std::cout << keys.create(name, *known) << '\n';
    std::cerr << "Keep it: it is not stored and cannot be shown again. Who has it acts as " << name << ".\n";
    return exit_status::ok;
  });
}

int list_keys_command(const std::string& state) {
  return with_keys(state, false, [](KeyStore& keys) {
    for (const ApiKey& key : keys.list())
      std::cout << fmt::format("{}  {:6}  created {}  {}{}\n", key.id, role_name(key.role),
                               rfc3339(key.created), key.name,
                               key.revoked ? "  revoked " + rfc3339(*key.revoked) : "");
    return exit_status::ok;
  });
}

int revoke_key_command(const std::string& state, const std::string& id) {
  return with_keys(state, false, [&](KeyStore& keys) {
    if (keys.revoke(id)) return exit_status::ok;
    std::cerr << "no key " << id << "; quicksand keys list shows the first column\n";
    return exit_status::failed;
  });
}

}  // namespace quicksand

#include "server/state_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "server/files.hpp"

namespace quicksand {

StateFolder::StateFolder(const std::filesystem::path& path) {
  std::error_code refused;
  std::filesystem::create_directories(path / "runs", refused);
  if (refused)
    throw std::runtime_error("cannot create the state folder " + path.string() + ": " + refused.message());
  path_ = std::filesystem::canonical(path);
  lock_ = ::open((path_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) throw std::runtime_error("cannot write in the state folder " + path_.string());
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    const std::string holder = read_text(path_ / "server.json").value_or("{}");
    throw std::runtime_error("another server uses the state folder " + path_.string() + ": " + holder);
  }
}

StateFolder::~StateFolder() {
  withdraw();
  ::close(lock_);
}

void StateFolder::announce(const std::string& url) {
  const nlohmann::ordered_json facts{{"url", url}, {"pid", ::getpid()}};
  write_atomically(path_ / "server.json", facts.dump());
}

void StateFolder::withdraw() {
  std::error_code ignored;
  std::filesystem::remove(path_ / "server.json", ignored);
}

}  // namespace quicksand

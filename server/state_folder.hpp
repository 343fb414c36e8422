#pragma once
#include <filesystem>
#include <string>

namespace quicksand {

/// Everything a server keeps: `quicksand.db`, `runs/<id>/`, `server.json` (url and pid while it serves).
/// Owned by one process at a time through a lock on `lock`, which the system frees when the process dies.
class StateFolder {
 public:
  /// Creates the folder if need be. Throws std::runtime_error, with who holds it, when another server does.
  explicit StateFolder(const std::filesystem::path& path);
  ~StateFolder();  ///< removes server.json and frees the lock
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path database() const { return path_ / "quicksand.db"; }
  std::filesystem::path runs() const { return path_ / "runs"; }
  std::filesystem::path run(const std::string& id) const { return runs() / id; }

  /// Tells others on this machine where the server listens.
  void announce(const std::string& url);
  void withdraw();

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace quicksand

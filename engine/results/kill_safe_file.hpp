#pragma once
// An HDF5 file that grows, and that a kill, a power loss or a full disk leaves readable up to its last flush.

#include <functional>
#include <string>

#include "engine/results/h5.hpp"

namespace quicksand {

class KillSafeFile {
 public:
  KillSafeFile() = default;
  /// Replaces one that is there.
  static KillSafeFile create(const std::string& path);
  /// What an interrupted writer left, to go on with it.
  static KillSafeFile open(const std::string& path);

  hid_t id() const { return file_.get(); }
  /// A group that many names will be added to.
  h5::Handle create_long_group(const char* name) const;

  /// Makes room for `bytes` more, then calls `work`, which writes, and flushes. Without room it throws
  /// std::runtime_error and nothing has changed. A failure in `work` leaves on disk what was there, and
  /// nothing can be written any more.
  void store(std::size_t bytes, const std::function<void()>& work);
  /// In `work`: what was written so far is on disk before what comes next. See ordered_driver.hpp.
  void flush() const;
  /// What was stored survives a power loss from here on.
  void to_disk() const;
  void close();

 private:
  explicit KillSafeFile(h5::Handle file) : file_(std::move(file)) {}
  int descriptor() const;

  h5::Handle file_;
  bool broken_ = false;
};

}  // namespace quicksand

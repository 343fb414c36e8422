#pragma once
#include <string>

#include "engine/run/run.hpp"

namespace quicksand {

/// An XDMF 3 file that shows `/frames` of a result file to ParaView. It is a complete document after each
/// `add`. All members throw std::runtime_error when the disk refuses; the document then still holds the
/// frames before.
class Xdmf {
 public:
  /// Creates `path`; `data_name` is the name of the HDF5 file beside it.
  Xdmf(const std::string& path, const std::string& data_name);
  /// Opens one that is there and keeps its first `frames` frames.
  Xdmf(const std::string& path, const std::string& data_name, std::size_t frames);
  ~Xdmf();
  Xdmf(const Xdmf&) = delete;
  Xdmf& operator=(const Xdmf&) = delete;

  /// `group` is the frame's group, e.g. "/frames/000042".
  void add(const Frame& frame, const std::string& group);
  void to_disk() const;

 private:
  void put(const std::string& text);

  std::string data_name_;
  int file_ = -1;
  long end_ = 0;  // where the closing tags stand and the next frame goes
};

}  // namespace quicksand

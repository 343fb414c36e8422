#pragma once
// The few HDF5 calls that results need. Each succeeds or throws h5::Error; HDF5's own printing is off.

#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace quicksand::h5 {

/// What was attempted and the system's reason, e.g. "cannot write Points: No space left on device".
/// Contains no path.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Owns one HDF5 identifier and closes it. Closing errors are ignored: what matters was flushed before.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  /// Throws Error(`what`, reason) when `id` is HDF5's answer to a failed call.
  Handle(hid_t id, Close close, const std::string& what);
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { reset(); }

  hid_t get() const { return id_; }
  void reset();
  hid_t release() { return std::exchange(id_, -1); }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Stops HDF5 from printing its error stack on the calling thread (the setting is per thread).
void silence();

/// Throws Error when `status` says that the call failed.
void check(herr_t status, const std::string& what);

/// Throws Error when the group cannot be read.
bool exists(hid_t parent, const std::string& name);
/// Throws Error unless every member of the group can be opened.
void require_whole(hid_t group);
/// Opens it if it is there.
Handle create_group(hid_t parent, const std::string& name);

/// In the file of `parent`; lost unless it is given a name.
Handle create_unnamed_group(hid_t parent);
void give_name(hid_t object, hid_t parent, const std::string& name);

/// Scalar or one-dimensional attribute; one that exists is overwritten in place and must have the same shape.
void put_attribute(hid_t object, const std::string& name, double value);
void put_attribute(hid_t object, const std::string& name, const std::vector<long long>& values);
/// Fixed-length string, ASCII as VTK expects it when `text` is ASCII and UTF-8 otherwise.
void put_attribute(hid_t object, const std::string& name, const std::string& text);

/// A scalar string dataset; replaces one of the same name.
void put_text(hid_t group, const std::string& name, const std::string& text);

/// Properties of a dataset without modification times, so that equal runs give equal files.
Handle dataset_properties();

enum class Storage {
  packed,   ///< shuffle + gzip 1: bulk data whose chunks are written once
  in_place  ///< plain chunks, rewritten where they are: a kill while they are rewritten harms no older row
};

/// A dataset of `columns` numbers per row (0: one-dimensional) that grows by rows.
class Table {
 public:
  Table() = default;
  /// One of the same name that is there is opened; `go_back` must then tell its rows.
  Table(hid_t group, const std::string& name, hid_t type, hsize_t columns, hsize_t chunk_rows,
        Storage storage);

  /// Writes `count` rows from row `at` on, extending the dataset; `rows` is in `memory_type`.
  void write(hsize_t at, hsize_t count, hid_t memory_type, const void* rows);
  void append(hsize_t count, hid_t memory_type, const void* rows) { write(rows_, count, memory_type, rows); }
  void append(long long value) { append(1, H5T_NATIVE_LLONG, &value); }
  void append(double value) { append(1, H5T_NATIVE_DOUBLE, &value); }

  /// Only the first `rows` count from here on; those behind are written over where they lie. Throws Error
  /// when there are fewer.
  void go_back(hsize_t rows);
  /// Removes rows that do not count. The file may become shorter, and a kill meanwhile spoil it.
  void trim();

  hsize_t rows() const { return rows_; }
  hsize_t columns() const { return columns_; }
  hid_t id() const { return dataset_.get(); }

 private:
  void set_extent(hsize_t rows);

  Handle dataset_;
  std::string name_;
  hsize_t columns_ = 0, rows_ = 0;
  hsize_t extent_ = 0;  // rows in the file
};

/// `count` rows of the table from row `from` on, as a dataset of its own without copying them (a virtual
/// dataset into `source`, the table's absolute path in the same file). One of the name that is there stays.
void put_view(hid_t group, const std::string& name, const Table& table, const std::string& source,
              hsize_t from, hsize_t count);

}  // namespace quicksand::h5

#include "engine/results/h5.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace quicksand::h5 {
namespace {

// HDF5 1.10.8 cannot close a file whose flush failed: it frees the file but keeps its identifier, and its
// exit handler then touches freed memory. Every file here is closed by its owner, so there is no need of the
// handler.
[[maybe_unused]] const herr_t without_exit_handler = H5dont_atexit();

constexpr unsigned gzip_level = 1;  // level 4 costs 40 % of the speed and saves 2–6 %

// HDF5 reports system errors as "…, errno = 28, error message = 'No space left on device', …".
herr_t find_system_reason(unsigned, const H5E_error2_t* entry, void* found) {
  constexpr std::string_view key = "error message = '";
  const std::string_view text = entry->desc ? entry->desc : "";
  const auto at = text.find(key);
  if (at != text.npos) {
    const auto rest = text.substr(at + key.size());
    *static_cast<std::string*>(found) = rest.substr(0, rest.find('\''));
  }
  return 0;
}

[[noreturn]] void fail(const std::string& what) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_system_reason, &reason);
  H5Eclear2(H5E_DEFAULT);
  throw Error(what + ": " + (reason.empty() ? "HDF5 refused" : reason));
}

Handle string_type(const std::string& text) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "cannot make a string type");
  check(H5Tset_size(type.get(), std::max<std::size_t>(text.size(), 1)), "cannot make a string type");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "cannot make a string type");
  const bool ascii = std::all_of(text.begin(), text.end(), [](char c) { return (c & 0x80) == 0; });
  check(H5Tset_cset(type.get(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8), "cannot make a string type");
  return type;
}

/// Chunks that are written once need no cache, which would keep up to 1 MB of each array.
Handle access_properties(Storage storage) {
  Handle properties(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose, "cannot make dataset properties");
  if (storage == Storage::packed)
    check(H5Pset_chunk_cache(properties.get(), H5D_CHUNK_CACHE_NSLOTS_DEFAULT, 0, H5D_CHUNK_CACHE_W0_DEFAULT),
          "cannot make dataset properties");
  return properties;
}

Handle scalar_space() { return Handle(H5Screate(H5S_SCALAR), H5Sclose, "cannot make a dataspace"); }

Handle row_space(hsize_t rows, hsize_t columns) {
  const std::array<hsize_t, 2> extent{rows, columns};
  return Handle(H5Screate_simple(columns ? 2 : 1, extent.data(), nullptr), H5Sclose,
                "cannot make a dataspace");
}

void select_rows(const Handle& space, hsize_t from, hsize_t count, hsize_t columns) {
  const std::array<hsize_t, 2> start{from, 0}, block{count, columns};
  check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr),
        "cannot select rows");
}

void write_attribute(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                     const Handle& space, const void* value) {
  const std::string what = "cannot write attribute " + name;
  const bool exists = H5Aexists(object, name.c_str()) > 0;
  const Handle attribute(
      exists ? H5Aopen(object, name.c_str(), H5P_DEFAULT)
             : H5Acreate2(object, name.c_str(), file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose, what);
  check(H5Awrite(attribute.get(), memory_type, value), what);
}

}  // namespace

Handle::Handle(hid_t id, Close close, const std::string& what) : id_(id), close_(close) {
  if (id < 0) fail(what);
}

void Handle::reset() {
  if (id_ >= 0) close_(id_);
  id_ = -1;
}

void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

void check(herr_t status, const std::string& what) {
  if (status < 0) fail(what);
}

bool exists(hid_t parent, const std::string& name) {
  const htri_t found = H5Lexists(parent, name.c_str(), H5P_DEFAULT);
  check(found, "cannot look for " + name);
  return found > 0;
}

void require_whole(hid_t group) {
  const auto open = [](hid_t in, const char* name, const H5L_info_t*, void*) -> herr_t {
    const hid_t object = H5Oopen(in, name, H5P_DEFAULT);
    return object < 0 ? -1 : H5Oclose(object);
  };
  hsize_t at = 0;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, &at, open, nullptr), "a kill has damaged a frame");
}

Handle create_group(hid_t parent, const std::string& name) {
  if (exists(parent, name))
    return Handle(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "cannot open group " + name);
  return Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                "cannot create group " + name);
}

Handle create_unnamed_group(hid_t parent) {
  return Handle(H5Gcreate_anon(parent, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "cannot create a group");
}

void give_name(hid_t object, hid_t parent, const std::string& name) {
  check(H5Olink(object, parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "cannot name " + name);
}

void put_attribute(hid_t object, const std::string& name, double value) {
  write_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, scalar_space(), &value);
}

void put_attribute(hid_t object, const std::string& name, const std::vector<long long>& values) {
  const Handle space = values.size() == 1 ? scalar_space() : row_space(values.size(), 0);
  write_attribute(object, name, H5T_STD_I64LE, H5T_NATIVE_LLONG, space, values.data());
}

void put_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Handle type = string_type(text);
  write_attribute(object, name, type.get(), type.get(), scalar_space(), text.c_str());
}

void put_text(hid_t group, const std::string& name, const std::string& text) {
  const std::string what = "cannot write document " + name;
  if (exists(group, name)) check(H5Ldelete(group, name.c_str(), H5P_DEFAULT), what);
  const Handle type = string_type(text), space = scalar_space(), properties = dataset_properties();
  const Handle dataset(
      H5Dcreate2(group, name.c_str(), type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose, what);
  check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), what);
}

Handle dataset_properties() {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "cannot make dataset properties");
  check(H5Pset_obj_track_times(properties.get(), false), "cannot make dataset properties");
  return properties;
}

Table::Table(hid_t group, const std::string& name, hid_t type, hsize_t columns, hsize_t chunk_rows,
             Storage storage)
    : name_(name), columns_(columns) {
  const Handle access = access_properties(storage);
  if (exists(group, name)) {
    dataset_ = Handle(H5Dopen2(group, name.c_str(), access.get()), H5Dclose, "cannot open dataset " + name);
    return;
  }
  const std::string what = "cannot create dataset " + name;
  const int rank = columns ? 2 : 1;
  const std::array<hsize_t, 2> now{0, columns}, most{H5S_UNLIMITED, columns}, chunk{chunk_rows, columns};
  const Handle space(H5Screate_simple(rank, now.data(), most.data()), H5Sclose, what);
  const Handle properties = dataset_properties();
  check(H5Pset_chunk(properties.get(), rank, chunk.data()), what);
  if (storage == Storage::packed) {
    check(H5Pset_shuffle(properties.get()), what);
    check(H5Pset_deflate(properties.get(), gzip_level), what);
  }
  dataset_ =
      Handle(H5Dcreate2(group, name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), access.get()),
             H5Dclose, what);
}

void Table::set_extent(hsize_t rows) {
  const std::array<hsize_t, 2> extent{rows, columns_};
  check(H5Dset_extent(dataset_.get(), extent.data()), "cannot write " + name_);
  extent_ = rows;
}

void Table::write(hsize_t at, hsize_t count, hid_t memory_type, const void* rows) {
  if (count == 0) return;
  const std::string what = "cannot write " + name_;
  rows_ = std::max(rows_, at + count);
  if (rows_ > extent_) set_extent(rows_);
  const Handle file_space(H5Dget_space(dataset_.get()), H5Sclose, what);
  select_rows(file_space, at, count, columns_);
  const Handle memory_space = row_space(count, columns_);
  check(H5Dwrite(dataset_.get(), memory_type, memory_space.get(), file_space.get(), H5P_DEFAULT, rows), what);
}

void Table::go_back(hsize_t rows) {
  const std::string what = "cannot read " + name_;
  const Handle space(H5Dget_space(dataset_.get()), H5Sclose, what);
  std::array<hsize_t, 2> extent{};
  check(H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr), what);
  if (extent[0] < rows) throw Error(what + ": it has fewer rows");
  extent_ = extent[0];
  rows_ = rows;
}

void Table::trim() {
  if (extent_ > rows_) set_extent(rows_);
}

void put_view(hid_t group, const std::string& name, const Table& table, const std::string& source,
              hsize_t from, hsize_t count) {
  if (exists(group, name)) return;
  const std::string what = "cannot create view " + name;
  const Handle properties = dataset_properties();
  const Handle view_space = row_space(count, table.columns());
  if (count > 0) {  // nothing can be mapped to nothing: an empty frame gets an empty plain dataset
    const Handle source_space = row_space(from + count, table.columns());
    select_rows(source_space, from, count, table.columns());
    check(H5Pset_virtual(properties.get(), view_space.get(), ".", source.c_str(), source_space.get()), what);
  }
  const Handle type(H5Dget_type(table.id()), H5Tclose, what);
  const Handle view(H5Dcreate2(group, name.c_str(), type.get(), view_space.get(), H5P_DEFAULT,
                               properties.get(), H5P_DEFAULT),
                    H5Dclose, what);
}

}  // namespace quicksand::h5

#include "engine/results/result_reader.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace quicksand {
namespace {

using h5::Handle;

/// Through another driver than the writer's: HDF5 would otherwise share the writer's open file, and with it
/// what is not yet on disk, and closing it would no longer close it.
Handle open_file(const std::string& path) {
  const std::string what = "cannot open the results";
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, what);
  h5::check(H5Pset_fapl_stdio(access.get()), what);
  h5::check(H5Pset_file_locking(access.get(), false, true), what);
  return Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose, what);
}

Handle open_group(hid_t parent, const std::string& name) {
  return Handle(H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "cannot open " + name);
}

Handle open_dataset(hid_t parent, const std::string& name) {
  return Handle(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open " + name);
}

Handle space_of(const Handle& dataset) {
  return Handle(H5Dget_space(dataset.get()), H5Sclose, "cannot read an extent");
}

/// Rows and columns; one column when it is one-dimensional.
std::array<hsize_t, 2> extent_of(const Handle& space) {
  std::array<hsize_t, 2> extent{0, 1};
  if (H5Sget_simple_extent_ndims(space.get()) > 2) throw h5::Error("an array of more than two dimensions");
  h5::check(H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr), "cannot read an extent");
  return extent;
}

std::vector<std::string> names_in(const Handle& group) {
  std::vector<std::string> names;
  const auto take = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  hsize_t at = 0;
  h5::check(H5Literate(group.get(), H5_INDEX_NAME, H5_ITER_INC, &at, take, &names), "cannot list a group");
  return names;
}

double number_attribute(const Handle& object, const char* name) {
  const Handle attribute(H5Aopen(object.get(), name, H5P_DEFAULT), H5Aclose, "cannot read an attribute");
  double value = 0;
  h5::check(H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value), "cannot read an attribute");
  return value;
}

std::string text_attribute(const Handle& object, const char* name) {
  const Handle attribute(H5Aopen(object.get(), name, H5P_DEFAULT), H5Aclose, "cannot read an attribute");
  const Handle type(H5Aget_type(attribute.get()), H5Tclose, "cannot read an attribute");
  std::string text(H5Tget_size(type.get()), '\0');
  h5::check(H5Aread(attribute.get(), type.get(), text.data()), "cannot read an attribute");
  return text.substr(0, text.find('\0'));
}

std::string frame_name(std::size_t index) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "frames/%06zu", index);
  return name.data();
}

FrameArray describe(const Handle& frame, const std::string& name) {
  const Handle dataset = open_dataset(frame.get(), name);
  const Handle type(H5Dget_type(dataset.get()), H5Tclose, "cannot read a type");
  FrameArray array{name, "float32", static_cast<std::size_t>(extent_of(space_of(dataset))[1]), 4};
  if (H5Tget_class(type.get()) == H5T_INTEGER) {
    array.item_bytes = H5Tget_size(type.get()) == 1 ? 1 : 4;
    array.type = array.item_bytes == 1 ? "uint8" : "int32";
  }
  return array;
}

hid_t memory_type(const FrameArray& array) {
  if (array.type == "uint8") return H5T_STD_U8LE;
  return array.type == "int32" ? H5T_STD_I32LE : H5T_IEEE_F32LE;
}

/// Rows 0, stride, 2 stride, … of a dataset into `bytes`.
void read_rows(const Handle& dataset, hid_t type, std::size_t count, std::size_t stride, void* bytes) {
  if (count == 0) return;
  const std::string what = "cannot read an array";
  const Handle space = space_of(dataset);
  const auto extent = extent_of(space);
  const std::array<hsize_t, 2> start{0, 0}, step{stride, 1}, rows{count, extent[1]};
  h5::check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), step.data(), rows.data(), nullptr),
            what);
  const hsize_t numbers = count * extent[1];
  const Handle memory(H5Screate_simple(1, &numbers, nullptr), H5Sclose, what);
  h5::check(H5Dread(dataset.get(), type, memory.get(), space.get(), H5P_DEFAULT, bytes), what);
}

}  // namespace

std::optional<ResultReader> ResultReader::open(const std::filesystem::path& run_folder) {
  h5::silence();
  // Twice: between looking and opening the run may end, and the file gets its final name.
  for (const char* name : {"result.vtkhdf", "result.vtkhdf.part", "result.vtkhdf"})
    if (std::error_code none; std::filesystem::exists(run_folder / name, none)) {
      try {
        return ResultReader(run_folder / name);
      } catch (const h5::Error&) {
        if (std::filesystem::exists(run_folder / name, none)) throw;
      }
    }
  return {};
}

ResultReader::ResultReader(const std::filesystem::path& file) : file_(open_file(file.string())) {
  if (H5Lexists(file_.get(), "frames", H5P_DEFAULT) <= 0) return;
  H5G_info_t facts{};
  h5::check(H5Gget_info(open_group(file_.get(), "frames").get(), &facts), "cannot count the frames");
  frames_ = static_cast<std::size_t>(facts.nlinks);
}

FrameShape ResultReader::frame(std::size_t index) const {
  const Handle group = open_group(file_.get(), frame_name(index));
  FrameShape shape;
  shape.time = number_attribute(group, "time");
  shape.stage = text_attribute(group, "stage");
  shape.points = static_cast<std::size_t>(extent_of(space_of(open_dataset(group.get(), "position")))[0]);
  for (const std::string& name : names_in(group))
    if (name != "vertex") shape.arrays.push_back(describe(group, name));  // vertex is for XDMF only
  return shape;
}

std::string ResultReader::array(std::size_t index, const FrameArray& array, std::size_t points,
                                std::size_t stride) const {
  const std::size_t count = (points + stride - 1) / stride;
  std::string bytes(count * array.components * array.item_bytes, '\0');
  const Handle dataset = open_dataset(file_.get(), frame_name(index) + "/" + array.name);
  read_rows(dataset, memory_type(array), count, stride, bytes.data());
  return bytes;
}

std::vector<SeriesShape> ResultReader::series() const {
  std::vector<SeriesShape> list;
  if (H5Lexists(file_.get(), "series", H5P_DEFAULT) <= 0) return list;
  const Handle group = open_group(file_.get(), "series");
  for (const std::string& name : names_in(group)) {
    const Handle value = open_dataset(group.get(), name + "/value");
    list.push_back(
        {name, text_attribute(value, "unit"), static_cast<std::size_t>(extent_of(space_of(value))[1])});
  }
  return list;
}

std::size_t ResultReader::samples(const std::string& series) const {
  const Handle time = open_dataset(file_.get(), "series/" + series + "/time");
  const Handle value = open_dataset(file_.get(), "series/" + series + "/value");
  return static_cast<std::size_t>(std::min(extent_of(space_of(time))[0], extent_of(space_of(value))[0]));
}

std::vector<double> ResultReader::times(const std::string& series, std::size_t samples) const {
  std::vector<double> numbers(samples);
  read_rows(open_dataset(file_.get(), "series/" + series + "/time"), H5T_NATIVE_DOUBLE, samples, 1,
            numbers.data());
  return numbers;
}

std::vector<double> ResultReader::values(const SeriesShape& series, std::size_t samples) const {
  std::vector<double> numbers(samples * series.components);
  read_rows(open_dataset(file_.get(), "series/" + series.name + "/value"), H5T_NATIVE_DOUBLE, samples, 1,
            numbers.data());
  return numbers;
}

}  // namespace quicksand

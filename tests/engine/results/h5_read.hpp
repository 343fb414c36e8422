#pragma once
// Reads a result file back with the plain C API, independent of the writer's own wrappers.

#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace quicksand::h5_read {

class File {
 public:
  explicit File(const std::string& path) : id_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {
    if (id_ < 0) throw std::runtime_error("cannot open " + path);
  }
  ~File() { H5Fclose(id_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  /// All numbers of a dataset, row after row.
  std::vector<double> doubles(const std::string& name) const {
    const hid_t dataset = open(name), space = H5Dget_space(dataset);
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    const herr_t status = H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    H5Dclose(dataset);
    if (status < 0) throw std::runtime_error("cannot read " + name);
    return values;
  }

  /// A string dataset; the padding of an empty one does not count.
  std::string text(const std::string& name) const {
    const hid_t dataset = open(name), type = H5Dget_type(dataset);
    std::string value(H5Tget_size(type), '\0');
    H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data());
    H5Tclose(type);
    H5Dclose(dataset);
    return value.c_str();
  }

  /// A scalar number.
  double attribute(const std::string& object, const std::string& name) const {
    const hid_t id = H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    double value = 0;
    const herr_t status = H5Aread(id, H5T_NATIVE_DOUBLE, &value);
    H5Aclose(id);
    if (status < 0) throw std::runtime_error("cannot read attribute " + name);
    return value;
  }

  bool has(const std::string& group, const std::string& name) const {
    return H5Lexists(id_, (group + "/" + name).c_str(), H5P_DEFAULT) > 0;
  }

 private:
  hid_t open(const std::string& name) const {
    const hid_t dataset = H5Dopen2(id_, name.c_str(), H5P_DEFAULT);
    if (dataset < 0) throw std::runtime_error("no dataset " + name);
    return dataset;
  }

  hid_t id_;
};

}  // namespace quicksand::h5_read

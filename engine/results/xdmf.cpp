#include "engine/results/xdmf.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace quicksand {
namespace {

constexpr const char* opening =
    "<?xml version=\"1.0\" ?>\n"
    "<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n"
    "<Xdmf Version=\"3.0\"><Domain>\n"
    "<Grid Name=\"points\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr const char* closing = "</Grid></Domain></Xdmf>\n";

// "Matrix" for all that is neither scalar nor vector: XDMF's Tensor6 has another order of components.
const char* attribute_type(int components) {
  return components == 1 ? "Scalar" : components == 3 ? "Vector" : "Matrix";
}

struct Item {
  const char* number_type;
  int precision;  // bytes
  int components;
};

std::string data_item(const std::string& source, std::size_t points, const Item& item) {
  std::ostringstream out;
  out << "<DataItem Dimensions=\"" << points;
  if (item.components > 1) out << ' ' << item.components;
  out << "\" NumberType=\"" << item.number_type << "\" Precision=\"" << item.precision << "\" Format=\"HDF\">"
      << source << "</DataItem>";
  return out.str();
}

std::string attribute(const std::string& name, const std::string& source, std::size_t points,
                      const Item& item) {
  return "<Attribute Name=\"" + name + "\" AttributeType=\"" + attribute_type(item.components) +
         "\" Center=\"Node\">" + data_item(source + name, points, item) + "</Attribute>\n";
}

std::string frame_mark(std::size_t index) { return "<Grid Name=\"frame" + std::to_string(index) + "\""; }

std::string grid(const Frame& frame, const std::string& source) {
  const std::size_t n = frame.points();
  std::ostringstream out;
  out.precision(17);
  out << frame_mark(frame.index) << " GridType=\"Uniform\"><Time Value=\"" << frame.time << "\"/>\n"
      << "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" << n << "\" NodesPerElement=\"1\">";
  if (n == 0) {  // ParaView's readers complain of empty data, not of absent data
    out << "</Topology>\n<Geometry GeometryType=\"XYZ\"/></Grid>\n";
    return out.str();
  }
  out << data_item(source + "vertex", n, {"Int", 8, 1}) << "</Topology>\n"
      << "<Geometry GeometryType=\"XYZ\">" << data_item(source + "position", n, {"Float", 8, 3})
      << "</Geometry>\n"
      << attribute("phase", source, n, {"UChar", 1, 1}) << attribute("body", source, n, {"Int", 4, 1});
  for (const FrameField& field : frame.fields)
    out << attribute(field.name, source, n, {"Float", 4, field.components});
  out << "</Grid>\n";
  return out.str();
}

/// The system's reason for a write that stored `done` bytes or failed with −1.
std::string reason(ssize_t done) { return std::generic_category().message(done < 0 ? errno : ENOSPC); }

}  // namespace

Xdmf::Xdmf(const std::string& path, const std::string& data_name) : data_name_(data_name) {
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file_ < 0) throw std::runtime_error("cannot create the xdmf file: " + reason(-1));
  put(opening);
}

Xdmf::Xdmf(const std::string& path, const std::string& data_name, std::size_t frames)
    : data_name_(data_name) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  const std::string whole = text.str();
  const auto at = [&](const std::string& mark) { return std::min(whole.find(mark), whole.size()); };
  const std::size_t end = std::min(at(frame_mark(frames)), at(closing));
  if (end == whole.size() || (frames > 0 && at(frame_mark(frames - 1)) == whole.size()))
    throw std::runtime_error("the xdmf file ends too soon");
  file_ = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  end_ = static_cast<long>(end);
  if (file_ < 0) throw std::runtime_error("cannot open the xdmf file: " + reason(-1));
  put("");
  if (ftruncate(file_, end_ + static_cast<long>(std::string_view(closing).size())) != 0)
    throw std::runtime_error("cannot cut the xdmf file: " + reason(-1));
}

void Xdmf::to_disk() const {
  if (fsync(file_) != 0) throw std::runtime_error("cannot write the xdmf file: " + reason(-1));
}

Xdmf::~Xdmf() {
  if (file_ >= 0) close(file_);
}

void Xdmf::add(const Frame& frame, const std::string& group) {
  put(grid(frame, data_name_ + ":" + group + "/"));
}

// One write of the new text with the closing tags over the old ones, so that a kill finds either document.
void Xdmf::put(const std::string& text) {
  const std::string whole = text + closing;
  const ssize_t done = pwrite(file_, whole.data(), whole.size(), end_);
  if (done == static_cast<ssize_t>(whole.size())) {
    end_ += static_cast<long>(text.size());
    return;
  }
  const std::string why = reason(done);
  const std::string tail = closing;  // its place exists already: put back what was there
  const bool restored = pwrite(file_, tail.data(), tail.size(), end_) == static_cast<ssize_t>(tail.size()) &&
                        ftruncate(file_, end_ + static_cast<long>(tail.size())) == 0;
  throw std::runtime_error("cannot write the xdmf file: " + why + (restored ? "" : "; it is damaged"));
}

}  // namespace quicksand

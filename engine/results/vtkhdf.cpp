#include "engine/results/vtkhdf.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>

namespace quicksand {
namespace {

using h5::Storage;
using h5::Table;

// Largest chunk of bulk data. Larger ones compress no better and make a stride read more.
constexpr hsize_t largest_chunk = 65536;
// Rows per chunk of the small index arrays: 0.5 kB each, one leaf of the chunk index for 4096 frames.
constexpr hsize_t index_chunk = 64;
// For a run that starts without any point.
constexpr hsize_t chunk_of_empty = 4096;

constexpr const char* cell_kinds[] = {"Vertices", "Lines", "Polygons", "Strips"};
constexpr hsize_t kinds = 4;

/// The largest equal parts of a frame that are not above `largest_chunk`: a run with a constant number of
/// points fills its chunks.
hsize_t chunk_for(hsize_t points) {
  if (points == 0) return chunk_of_empty;
  const hsize_t parts = (points + largest_chunk - 1) / largest_chunk;
  return (points + parts - 1) / parts;
}

hsize_t up_to_multiple(hsize_t rows, hsize_t of) { return (rows + of - 1) / of * of; }

Table index_table(hid_t group, const char* name, hsize_t columns = 0) {
  return Table(group, name, H5T_STD_I64LE, columns, index_chunk, Storage::in_place);
}

hsize_t columns_of(const FrameField& field) {
  return field.components == 1 ? 0 : static_cast<hsize_t>(field.components);
}

}  // namespace

Vtkhdf::Vtkhdf(hid_t file)
    : root_(h5::create_group(file, "VTKHDF")),
      point_data_(h5::create_group(root_.get(), "PointData")),
      steps_(h5::create_group(root_.get(), "Steps")),
      point_data_offsets_(h5::create_group(steps_.get(), "PointDataOffsets")) {
  h5::put_attribute(root_.get(), "Version", std::vector<long long>{2, 0});
  h5::put_attribute(root_.get(), "Type", std::string("PolyData"));
  number_of_points_ = index_table(root_.get(), "NumberOfPoints");
  values_ = Table(steps_.get(), "Values", H5T_IEEE_F64LE, 0, index_chunk, Storage::in_place);
  number_of_parts_ = index_table(steps_.get(), "NumberOfParts");
  part_offsets_ = index_table(steps_.get(), "PartOffsets");
  point_offsets_ = index_table(steps_.get(), "PointOffsets");
  cell_offsets_ = index_table(steps_.get(), "CellOffsets", kinds);
  id_offsets_ = index_table(steps_.get(), "ConnectivityIdOffsets", kinds);
  h5::put_attribute(steps_.get(), "NSteps", std::vector<long long>{0});
}

template <class F>
void Vtkhdf::for_tables(F&& f) {
  for (h5::Table* table : {&number_of_points_, &values_, &number_of_parts_, &part_offsets_, &point_offsets_,
                           &cell_offsets_, &id_offsets_})
    f(*table);
  if (chunk_rows_ == 0) return;
  f(*points_);
  for (Cells& cells : cells_)
    for (h5::Table* table :
         {&cells.connectivity, &cells.offsets, &cells.number_of_cells, &cells.number_of_ids})
      f(*table);
  for (auto& [name, table] : arrays_) f(table);
  for (auto& [name, table] : array_offsets_) f(table);
}

Vtkhdf::Extent Vtkhdf::extent() {
  Extent extent{described_, chunk_rows_, frames_, {}};
  for_tables([&](h5::Table& table) { extent.rows.push_back(table.rows()); });
  return extent;
}

void Vtkhdf::go_back(const Extent& to) {
  chunk_rows_ = to.chunk_rows;
  frames_ = to.frames;
  if (chunk_rows_ > 0) create_bulk(to.fields);
  std::size_t next = 0;
  for_tables([&](h5::Table& table) { table.go_back(to.rows.at(next++)); });
}

void Vtkhdf::trim() {
  for_tables([](h5::Table& table) { table.trim(); });
  h5::put_attribute(steps_.get(), "NSteps", std::vector<long long>{frames_});
}

void Vtkhdf::create_bulk(const std::vector<FrameField>& fields) {
  for (const char* kind : cell_kinds) {
    const bool used = cells_.empty();  // the vertices come first
    const auto storage = used ? Storage::packed : Storage::in_place;
    const hsize_t chunk = used ? chunk_rows_ : index_chunk;
    h5::Handle group = h5::create_group(root_.get(), kind);
    Cells cells{{},
                Table(group.get(), "Connectivity", H5T_STD_I64LE, 0, chunk, storage),
                Table(group.get(), "Offsets", H5T_STD_I64LE, 0, used ? chunk + 1 : chunk, storage),
                index_table(group.get(), "NumberOfCells"),
                index_table(group.get(), "NumberOfConnectivityIds")};
    cells.group = std::move(group);
    cells_.push_back(std::move(cells));
  }
  points_ = Table(root_.get(), "Points", H5T_IEEE_F64LE, 3, chunk_rows_, Storage::packed);
  h5::put_attribute(points_->id(), "unit", std::string("m"));

  const auto add = [&](const std::string& name, hid_t type, hsize_t columns, const std::string& unit) {
    arrays_.emplace_back(name, Table(point_data_.get(), name, type, columns, chunk_rows_, Storage::packed));
    h5::put_attribute(arrays_.back().second.id(), "unit", unit);
    array_offsets_.emplace(name, index_table(point_data_offsets_.get(), name.c_str()));
  };
  add("phase", H5T_STD_U8LE, 0, "0 solid, 1 water");
  add("body", H5T_STD_I32LE, 0, "index into bodies");
  for (const FrameField& field : fields) {
    add(field.name, H5T_IEEE_F32LE, columns_of(field), field.unit);
    described_.push_back({field.name, field.unit, field.components, {}});
  }
}

void Vtkhdf::require_same_fields(const Frame& frame) const {
  const std::size_t n = frame.points();
  bool same =
      frame.fields.size() == described_.size() && frame.position.size() == 3 * n && frame.body.size() == n;
  for (std::size_t i = 0; same && i < described_.size(); ++i) {
    const FrameField& field = frame.fields[i];
    same = field.name == described_[i].name && field.components == described_[i].components &&
           field.values.size() == n * static_cast<std::size_t>(field.components);
  }
  if (!same)
    throw std::logic_error("frame with other fields than the first, or of other length than its points");
}

Vtkhdf::Rows Vtkhdf::append(const Frame& frame) {
  if (chunk_rows_ == 0) {
    chunk_rows_ = chunk_for(frame.points());
    create_bulk(frame.fields);
  }
  require_same_fields(frame);
  Rows rows;
  rows.count = frame.points();
  rows.points = up_to_multiple(points_->rows(), chunk_rows_);

  points_->write(rows.points, rows.count, H5T_NATIVE_DOUBLE, frame.position.data());
  arrays_[0].second.write(rows.points, rows.count, H5T_NATIVE_UINT8, frame.phase.data());
  arrays_[1].second.write(rows.points, rows.count, H5T_NATIVE_INT32, frame.body.data());
  for (std::size_t i = 0; i < frame.fields.size(); ++i)
    arrays_[2 + i].second.write(rows.points, rows.count, H5T_NATIVE_FLOAT, frame.fields[i].values.data());
  append_vertices(rows);
  append_step(frame, rows);
  return rows;
}

// Every frame's connectivity is 0, 1, 2, … : one stretch, as long as the largest frame, serves them all.
void Vtkhdf::append_vertices(Rows& rows) {
  Cells& vertices = cells_.front();
  const hsize_t had = vertices.connectivity.rows();
  const hsize_t needed = std::max(up_to_multiple(rows.count, chunk_rows_), had);
  if (iota_.size() < needed + 1) {
    const std::size_t counted = iota_.size();
    iota_.resize(needed + 1);
    std::iota(iota_.begin() + static_cast<std::ptrdiff_t>(counted), iota_.end(),
              static_cast<long long>(counted));
  }
  vertices.connectivity.append(needed - had, H5T_NATIVE_LLONG, iota_.data() + had);
  // Readers look for a frame's offsets at CellOffsets + number of frames before (one row more than cells
  // each).
  const hsize_t first = up_to_multiple(vertices.offsets.rows(), chunk_rows_ + 1);
  vertices.offsets.write(first, rows.count + 1, H5T_NATIVE_LLONG, iota_.data());
  rows.cells = static_cast<long long>(first) - frames_;
  for (Cells& cells : cells_) {
    const bool used = &cells == &vertices;
    if (!used) cells.offsets.append(0LL);
    cells.number_of_cells.append(used ? static_cast<long long>(rows.count) : 0LL);
    cells.number_of_ids.append(used ? static_cast<long long>(rows.count) : 0LL);
  }
}

void Vtkhdf::append_step(const Frame& frame, const Rows& rows) {
  number_of_points_.append(static_cast<long long>(rows.count));
  values_.append(frame.time);
  number_of_parts_.append(1LL);
  part_offsets_.append(frames_);
  point_offsets_.append(static_cast<long long>(rows.points));
  const std::array<long long, kinds> first_cell{rows.cells, 0, 0, 0}, first_id{};
  cell_offsets_.append(1, H5T_NATIVE_LLONG, first_cell.data());
  id_offsets_.append(1, H5T_NATIVE_LLONG, first_id.data());
  for (auto& [name, offsets] : array_offsets_) offsets.append(static_cast<long long>(rows.points));
}

void Vtkhdf::count_frame() { h5::put_attribute(steps_.get(), "NSteps", std::vector<long long>{++frames_}); }

void Vtkhdf::put_views(hid_t group, const Rows& rows) const {
  h5::put_view(group, "position", *points_, "/VTKHDF/Points", rows.points, rows.count);
  for (const auto& [name, array] : arrays_)
    h5::put_view(group, name, array, "/VTKHDF/PointData/" + name, rows.points, rows.count);
  h5::put_view(group, "vertex", cells_[0].connectivity, "/VTKHDF/Vertices/Connectivity", 0, rows.count);
}

}  // namespace quicksand

#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/results/h5.hpp"
#include "engine/run/run.hpp"

namespace quicksand {

/// The group `/VTKHDF` (VTKHDF 2.0, PolyData of vertices, temporal): every frame's points one after the
/// other, and `Steps` that say where each frame lies. A frame starts on a chunk boundary, so a chunk of bulk
/// data is written once and never moved, and a kill while a frame is written cannot harm the frames before;
/// rows between frames hold zeros and belong to no frame.
class Vtkhdf {
 public:
  /// Rows of the frame just appended.
  struct Rows {
    hsize_t points = 0;  ///< first row in Points and PointData
    hsize_t count = 0;
    long long cells = 0;  ///< the frame's Steps/CellOffsets of vertices
  };

  /// Opens the group if it is there.
  explicit Vtkhdf(hid_t file);

  /// The first frame fixes the fields; a later one with others is a std::logic_error.
  Rows append(const Frame& frame);
  /// The frame just appended is part of the file from here on.
  void count_frame();

  /// What of it is not in the file, or would have to be found out.
  struct Extent {
    std::vector<FrameField> fields;  ///< without values
    hsize_t chunk_rows = 0;          ///< 0: no frame yet
    long long frames = 0;
    std::vector<hsize_t> rows;  ///< of each table
    template <class A>
    void keep(A& a) {
      a(fields, chunk_rows, frames, rows);
    }
  };
  Extent extent();
  /// Of a group that was opened: what came after is written over.
  void go_back(const Extent& to);
  /// Removes what was not; see Table::trim.
  void trim();

  /// Makes `group` show the frame's rows: position, phase, body, every field, vertex.
  void put_views(hid_t group, const Rows& rows) const;

 private:
  struct Cells {  // one of VTK's four cell kinds; only vertices are ever used
    h5::Handle group;
    h5::Table connectivity, offsets, number_of_cells, number_of_ids;
  };

  void create_bulk(const std::vector<FrameField>& fields);
  /// f(table) for every table, in a fixed order.
  template <class F>
  void for_tables(F&& f);
  void require_same_fields(const Frame& frame) const;
  void append_vertices(Rows& rows);
  void append_step(const Frame& frame, const Rows& rows);

  h5::Handle root_, point_data_, steps_, point_data_offsets_;
  h5::Table number_of_points_;
  std::vector<Cells> cells_;
  h5::Table values_, number_of_parts_, part_offsets_, point_offsets_, cell_offsets_, id_offsets_;

  hsize_t chunk_rows_ = 0;  // 0: no frame yet
  std::optional<h5::Table> points_;
  std::vector<FrameField> described_;                      // names and components, without values
  std::vector<std::pair<std::string, h5::Table>> arrays_;  // PointData: phase, body, fields in order
  std::map<std::string, h5::Table> array_offsets_;
  std::vector<long long> iota_;
  long long frames_ = 0;
};

}  // namespace quicksand

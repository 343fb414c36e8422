#pragma once
// Pieces of planes of cell faces, on which walls, gates, reservoirs, sections and plates lie.

#include <optional>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// A straight line of cell faces in the plane, a rectangle of them in space. In whole cells from domain.min;
/// in the plane the third axis holds one cell.
struct GridPatch {
  std::size_t normal = 0;             ///< axis along which it has no extent
  std::array<long, 3> low{}, high{};  ///< equal along the normal
  long position() const { return low[normal]; }
};

/// The patch that a segment spans (in space by two opposite corners); nothing, and faults, if it spans none.
std::optional<GridPatch> check_patch(const Scene& scene, const Segment& segment, const std::string& pointer,
                                     std::vector<Fault>& faults);
/// Adds a fault unless the point is a corner of cells.
bool check_corner(const Scene& scene, const Vec3& point, const std::string& pointer,
                  std::vector<Fault>& faults);

bool on_edge(const Scene& scene, const GridPatch& patch);  ///< of the domain
bool overlap(const GridPatch& a, const GridPatch& b);      ///< they share a face

/// Cells from `low` (held) to `high` (not held).
struct CellBox {
  std::array<long, 3> low{}, high{};
  bool operator==(const CellBox&) const = default;
};
CellBox cell_box(const Scene& scene, const Region& box);
/// The layer of cells beside the patch on its lower (0) or upper (1) side.
CellBox beside(const GridPatch& patch, int side);
bool within(const CellBox& inner, const CellBox& outer);
bool meet(const CellBox& a, const CellBox& b);

/// Distance from the domain's lower corner in cells.
double in_cells(const Scene& scene, std::size_t axis, double coordinate);
/// Whether a distance in cells is a whole number, but for rounding.
bool whole(double cells);
bool in_domain(const Scene& scene, const Vec3& point);
std::string outside_words(const Scene& scene, const Vec3& point);

}  // namespace quicksand

#include "engine/scene/grid_patch.hpp"

#include <algorithm>
#include <cmath>

#include "engine/scene/check_parts.hpp"

namespace quicksand {
namespace {

/// Coordinates within this share of a cell of a face lie on it: far above rounding, far below what matters.
constexpr double face_tolerance = 1e-6;

Vec3 nearest_corner(const Scene& scene, const Vec3& point) {
  Vec3 corner{};
  for (std::size_t axis = 0; axis < axes(scene); ++axis)
    corner[axis] =
        scene.domain.min[axis] + std::round(in_cells(scene, axis, point[axis])) * scene.cell_size();
  return corner;
}

/// What is wrong with the extent of a segment that runs along `along` axes; empty if nothing.
std::string shape_words(const Scene& scene, const Segment& segment, std::size_t along) {
  const std::size_t wanted = axes(scene) - 1;
  if (along == wanted) return {};
  if (along == 0) return "has no length";
  const std::string ends = "from " + text(scene, segment.from) + " to " + text(scene, segment.to);
  if (wanted == 1) return ends + " does not run along a grid axis: make x or y equal";
  return ends + " is not a rectangle between two opposite corners: exactly one of x, y and z must be equal";
}

}  // namespace

double in_cells(const Scene& scene, std::size_t axis, double coordinate) {
  return (coordinate - scene.domain.min[axis]) / scene.cell_size();
}

bool whole(double cells) { return std::abs(cells - std::round(cells)) <= face_tolerance; }

bool in_domain(const Scene& scene, const Vec3& point) {
  const double slack = face_tolerance * scene.cell_size();
  for (std::size_t axis = 0; axis < axes(scene); ++axis)
    if (point[axis] < scene.domain.min[axis] - slack || point[axis] > scene.domain.max[axis] + slack)
      return false;
  return true;
}

std::string outside_words(const Scene& scene, const Vec3& point) {
  return text(scene, point) + " is outside the domain " + text(scene, scene.domain.min) + " to " +
         text(scene, scene.domain.max);
}

bool check_corner(const Scene& scene, const Vec3& point, const std::string& pointer,
                  std::vector<Fault>& faults) {
  bool on_corner = true;
  for (std::size_t axis = 0; axis < axes(scene); ++axis)
    on_corner = on_corner && whole(in_cells(scene, axis, point[axis]));
  if (!in_domain(scene, point))
    faults.push_back({pointer, outside_words(scene, point)});
  else if (!on_corner)
    faults.push_back({pointer, text(scene, point) + " is not on a corner of " + cell_words(scene) +
                                   ": the nearest is " + text(scene, nearest_corner(scene, point))});
  else
    return true;
  return false;
}

std::optional<GridPatch> check_patch(const Scene& scene, const Segment& segment, const std::string& pointer,
                                     std::vector<Fault>& faults) {
  GridPatch patch;
  std::size_t along = 0;
  for (std::size_t axis = 0; axis < axes(scene); ++axis) {
    const bool extends = std::abs(segment.to[axis] - segment.from[axis]) > face_tolerance * scene.cell_size();
    along += extends ? 1 : 0;
    if (!extends) patch.normal = axis;
  }
  const std::string wrong = shape_words(scene, segment, along);
  if (!wrong.empty()) faults.push_back({pointer, wrong});
  const bool from = check_corner(scene, segment.from, pointer + "/from", faults);
  const bool to = check_corner(scene, segment.to, pointer + "/to", faults);
  if (!wrong.empty() || !from || !to) return std::nullopt;
  patch.low[2] = 0, patch.high[2] = 1;
  for (std::size_t axis = 0; axis < axes(scene); ++axis) {
    patch.low[axis] = std::lround(in_cells(scene, axis, segment.from[axis]));
    patch.high[axis] = std::lround(in_cells(scene, axis, segment.to[axis]));
    if (patch.low[axis] > patch.high[axis]) std::swap(patch.low[axis], patch.high[axis]);
  }
  patch.high[patch.normal] = patch.low[patch.normal];
  return patch;
}

bool on_edge(const Scene& scene, const GridPatch& patch) {
  return patch.position() == 0 || patch.position() == cells_along(scene, patch.normal);
}

bool overlap(const GridPatch& a, const GridPatch& b) {
  return a.normal == b.normal && a.position() == b.position() && meet(beside(a, 0), beside(b, 0));
}

CellBox cell_box(const Scene& scene, const Region& box) {
  CellBox cells{{0, 0, 0}, {1, 1, 1}};
  for (std::size_t axis = 0; axis < axes(scene); ++axis) {
    cells.low[axis] = std::lround(in_cells(scene, axis, box.min[axis]));
    cells.high[axis] = std::lround(in_cells(scene, axis, box.max[axis]));
  }
  return cells;
}

CellBox beside(const GridPatch& patch, int side) {
  CellBox cells{patch.low, patch.high};
  cells.low[patch.normal] += side - 1;
  cells.high[patch.normal] += side;
  return cells;
}

bool within(const CellBox& inner, const CellBox& outer) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (inner.low[axis] < outer.low[axis] || inner.high[axis] > outer.high[axis]) return false;
  return true;
}

bool meet(const CellBox& a, const CellBox& b) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (std::max(a.low[axis], b.low[axis]) >= std::min(a.high[axis], b.high[axis])) return false;
  return true;
}

}  // namespace quicksand

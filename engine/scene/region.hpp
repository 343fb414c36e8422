#pragma once
// Geometry of regions. A region is closed below and open above, so that regions which share an edge share no
// point. In the plane third components are ignored; polygons and discs are extruded along z in space.

#include <array>
#include <cstddef>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

bool contains(const Region& region, const Vec3& point, int dimensions = 2);

struct Bounds {
  Vec3 min{}, max{};
  bool empty = true;
};
/// Smallest box around the region (for a difference: around its first part). z is 0 for polygons and discs.
Bounds bounding_box(const Region& region);

/// Sorted, disjoint intervals [from, to) of a line.
using Stretches = std::vector<std::array<double, 2>>;

/// The part of a line inside a region of the plane. `axis` 0: the line y = `at`, stretches in x; `axis` 1:
/// the line x = `at`, stretches in y. For axis 0, x lies in a stretch exactly when contains(region, {x, at}).
Stretches stretches(const Region& region, int axis, double at);

/// The region as it is cut by the plane at depth z: boxes that do not reach there hold nothing.
Region at_depth(Region region, double z);

/// Area of a region of the plane in m², by lines `spacing` metres apart (relative error of order
/// spacing/size).
double area(const Region& region, double spacing);

/// Where sides of the region stand square to an axis: faces of boxes, edges of polygons.
std::vector<double> square_sides(const Region& region, std::size_t axis);

/// Number of edges to look at: 4 for a box or a disc, vertices of a polygon, sum of the parts.
std::size_t edge_count(const Region& region);

/// True when two edges of the polygon that are not neighbours meet.
bool crosses_itself(const std::vector<std::array<double, 2>>& vertices);

}  // namespace quicksand

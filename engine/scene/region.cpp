#include "engine/scene/region.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace quicksand {
namespace {

using Point = std::array<double, 2>;

/// Calls f(x) for every edge that the line at height y crosses, in the frame turned so that the line runs
/// along `axis`. An edge holds its lower end and not its upper one, and is evaluated from the lower end
/// whichever way round it is given, so that two polygons with a common edge agree on it to the last bit.
template <typename F>
void for_crossings(const std::vector<Point>& vertices, std::size_t axis, double at, const F& f) {
  const std::size_t other = 1 - axis;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Point* low = &vertices[k];
    const Point* high = &vertices[(k + 1) % vertices.size()];
    if ((*low)[other] > (*high)[other]) std::swap(low, high);
    if (at < (*low)[other] || at >= (*high)[other]) continue;
    const double share = (at - (*low)[other]) / ((*high)[other] - (*low)[other]);
    f((*low)[axis] + share * ((*high)[axis] - (*low)[axis]));
  }
}

/// Half the length of the chord at distance `offset` from the centre; negative outside.
double half_chord(double radius, double offset) {
  const double square = radius * radius - offset * offset;
  return square > 0 ? std::sqrt(square) : -1;
}

bool in_polygon(const std::vector<Point>& vertices, const Vec3& point) {
  bool inside = false;
  for_crossings(vertices, 0, point[1], [&](double x) { inside ^= x <= point[0]; });
  return inside;
}

bool in_disc(const Region& disc, const Vec3& point) {
  const double half = half_chord(disc.radius, point[1] - disc.center[1]);
  return half >= 0 && disc.center[0] - half <= point[0] && point[0] < disc.center[0] + half;
}

bool in_box(const Region& box, const Vec3& point, int dimensions) {
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimensions); ++axis)
    if (point[axis] < box.min[axis] || point[axis] >= box.max[axis]) return false;
  return true;
}

void add_bounds(Bounds& bounds, const Vec3& min, const Vec3& max) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bounds.min[axis] = bounds.empty ? min[axis] : std::min(bounds.min[axis], min[axis]);
    bounds.max[axis] = bounds.empty ? max[axis] : std::max(bounds.max[axis], max[axis]);
  }
  bounds.empty = false;
}

Stretches polygon_stretches(const std::vector<Point>& vertices, std::size_t axis, double at) {
  std::vector<double> crossings;
  for_crossings(vertices, axis, at, [&](double x) { crossings.push_back(x); });
  std::sort(crossings.begin(), crossings.end());
  Stretches all;
  for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
    if (crossings[k] < crossings[k + 1]) all.push_back({crossings[k], crossings[k + 1]});
  return all;
}

/// Sorts and joins stretches that touch or overlap.
Stretches joined(Stretches loose) {
  std::sort(loose.begin(), loose.end());
  Stretches all;
  for (const auto& s : loose)
    if (!all.empty() && s[0] <= all.back()[1])
      all.back()[1] = std::max(all.back()[1], s[1]);
    else
      all.push_back(s);
  return all;
}

Stretches without(const Stretches& a, const Stretches& holes) {
  Stretches all;
  std::size_t first = 0;  // holes before it end before the stretch at hand begins
  for (const auto& s : a) {
    double from = s[0];
    while (first < holes.size() && holes[first][1] <= from) ++first;
    for (std::size_t k = first; k < holes.size() && holes[k][0] < s[1]; ++k) {
      if (holes[k][0] > from) all.push_back({from, holes[k][0]});
      from = holes[k][1];
    }
    if (from < s[1]) all.push_back({from, s[1]});
  }
  return all;
}

/// Twice the signed area of the triangle a b c.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool edges_meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  for (const std::size_t axis : {0u, 1u})  // apart along an axis
    if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
        std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
      return false;
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

/// Stretches of the parts from index `first` on, taken together.
Stretches joined_parts(const Region& region, std::size_t first, int axis, double at) {
  Stretches all;
  for (std::size_t k = first; k < region.parts.size(); ++k) {
    const Stretches part = stretches(region.parts[k], axis, at);
    all.insert(all.end(), part.begin(), part.end());
  }
  return joined(std::move(all));
}

}  // namespace

bool contains(const Region& region, const Vec3& point, int dimensions) {
  const auto inside = [&](const Region& part) { return contains(part, point, dimensions); };
  const auto& parts = region.parts;
  switch (region.kind) {
    case Region::Kind::box:
      return in_box(region, point, dimensions);
    case Region::Kind::polygon:
      return in_polygon(region.vertices, point);
    case Region::Kind::disc:
      return in_disc(region, point);
    case Region::Kind::union_of:
      return std::any_of(parts.begin(), parts.end(), inside);
    case Region::Kind::difference:
      return !parts.empty() && inside(parts[0]) && std::none_of(parts.begin() + 1, parts.end(), inside);
  }
  return false;
}

Bounds bounding_box(const Region& region) {
  Bounds bounds;
  const auto& c = region.center;
  const double r = region.radius;
  switch (region.kind) {
    case Region::Kind::box:
      add_bounds(bounds, region.min, region.max);
      break;
    case Region::Kind::polygon:
      for (const Point& v : region.vertices) add_bounds(bounds, {v[0], v[1], 0}, {v[0], v[1], 0});
      break;
    case Region::Kind::disc:
      add_bounds(bounds, {c[0] - r, c[1] - r, 0}, {c[0] + r, c[1] + r, 0});
      break;
    case Region::Kind::union_of:
      for (const Region& part : region.parts)
        if (const Bounds b = bounding_box(part); !b.empty) add_bounds(bounds, b.min, b.max);
      break;
    case Region::Kind::difference:
      if (!region.parts.empty()) bounds = bounding_box(region.parts[0]);
      break;
  }
  return bounds;
}

Stretches stretches(const Region& region, int line_axis, double at) {
  const auto axis = static_cast<std::size_t>(line_axis);
  const std::size_t other = 1 - axis;
  switch (region.kind) {
    case Region::Kind::box:
      if (at < region.min[other] || at >= region.max[other] || region.min[axis] >= region.max[axis])
        return {};
      return {{region.min[axis], region.max[axis]}};
    case Region::Kind::polygon:
      return polygon_stretches(region.vertices, axis, at);
    case Region::Kind::disc: {
      const double half = half_chord(region.radius, at - region.center[other]);
      if (half <= 0) return {};
      return {{region.center[axis] - half, region.center[axis] + half}};
    }
    case Region::Kind::union_of:
      return joined_parts(region, 0, line_axis, at);
    case Region::Kind::difference:
      if (region.parts.empty()) return {};
      return without(stretches(region.parts[0], line_axis, at), joined_parts(region, 1, line_axis, at));
  }
  return {};
}

Region at_depth(Region region, double z) {
  if (region.kind == Region::Kind::box && (z < region.min[2] || z >= region.max[2])) {
    region.kind = Region::Kind::union_of;
    region.parts.clear();
  }
  for (Region& part : region.parts) part = at_depth(std::move(part), z);
  return region;
}

std::vector<double> square_sides(const Region& region, std::size_t axis) {
  std::vector<double> sides;
  if (region.kind == Region::Kind::box) sides = {region.min[axis], region.max[axis]};
  const auto& corners = region.vertices;
  for (std::size_t k = 0; axis < 2 && k < corners.size(); ++k)
    if (corners[k][axis] == corners[(k + 1) % corners.size()][axis]) sides.push_back(corners[k][axis]);
  for (const Region& part : region.parts)
    for (const double x : square_sides(part, axis)) sides.push_back(x);
  return sides;
}

double area(const Region& region, double spacing) {
  const Bounds bounds = bounding_box(region);
  if (bounds.empty) return 0;
  const double height = bounds.max[1] - bounds.min[1];
  const auto lines = std::max(1L, std::lround(height / spacing));
  const double step = height / static_cast<double>(lines);
  double total = 0;
  for (long k = 0; k < lines; ++k)
    for (const auto& s : stretches(region, 0, bounds.min[1] + (static_cast<double>(k) + 0.5) * step))
      total += (s[1] - s[0]) * step;
  return total;
}

std::size_t edge_count(const Region& region) {
  if (region.kind == Region::Kind::polygon) return region.vertices.size();
  if (region.kind == Region::Kind::box || region.kind == Region::Kind::disc) return 4;
  return std::accumulate(region.parts.begin(), region.parts.end(), std::size_t{0},
                         [](std::size_t sum, const Region& part) { return sum + edge_count(part); });
}

bool crosses_itself(const std::vector<Point>& v) {
  const std::size_t n = v.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours across the end of the list
      if (edges_meet(v[i], v[i + 1], v[j], v[(j + 1) % n])) return true;
    }
  return false;
}

}  // namespace quicksand

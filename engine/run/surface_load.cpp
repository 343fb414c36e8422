#include "engine/run/surface_load.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace quicksand {
namespace {

/// Depth over which a load is handed to the soil, in cells: twice what a kernel reaches. Deeper: more
/// markers.
constexpr double kLoadDepth = 3;

/// χ at a depth, as part of the layer's: 1 … 0, flat at either end.
double share_above(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return 1 - u * u * u * (10 - u * (15 - 6 * u));
}

/// Adds the markers of one row of points, whose distances from the outermost are `depth`, ascending.
template <int D>
void add_row(const Grid<D>& grid, std::vector<Vec<D>>& row, int axis, int out, double spacing,
             std::vector<LoadMarker<D>>& markers) {
  std::sort(row.begin(), row.end(),
            [&](const Vec<D>& a, const Vec<D>& b) { return out * (a[axis] - b[axis]) > 0; });
  const auto depth = [&](std::size_t k) { return out * (row[0][axis] - row[k][axis]); };  // m, from the first
  std::size_t count = 1;
  while (count < row.size() && depth(count) - depth(count - 1) < 1.5 * spacing) ++count;
  const double layer = std::min(kLoadDepth * grid.h, depth(count - 1) + spacing);
  const auto place = [&](double below) {  // m, from the surface
    Vec<D> x = row[0];
    x[axis] += out * (0.5 * spacing - below);
    return x;
  };
  const double area = (D == 2 ? spacing : spacing * spacing) * grid.radius(place(0));
  const auto add = [&](double below, double part_area, double part_volume) {
    LoadMarker<D> m{.x = place(below), .area = part_area, .volume = part_volume};
    m.normal[axis] = out;
    markers.push_back(m);
  };
  double above = 1;  // χ over the edge between two points
  std::size_t k = 0;
  for (; k < count && depth(k) + 0.5 * spacing < layer; ++k) {
    const double chi = share_above((depth(k) + 0.5 * spacing) / layer);
    if (chi < above) add(depth(k), area * (above - chi), 0);
    add(depth(k) + 0.5 * spacing, 0, area * spacing * chi);
    above = chi;
  }
  add(depth(k - 1) + spacing, area * above, 0);
}

}  // namespace

template <int D>
SurfaceLoad<D> make_load(const Scene& scene, const Load& load, const State<D>& s) {
  const double spacing = s.grid.h / scene.numerics.points_per_cell;
  const int axis = static_cast<int>(load.side) / 2, out = static_cast<int>(load.side) % 2 ? 1 : -1;
  std::map<std::array<long, D>, std::vector<Vec<D>>> rows;  // by row of seeding places across the side
  for (std::size_t p = 0; p < s.soil.size(); ++p) {
    if (scene.bodies[s.soil.body[p]].name != load.body) continue;
    std::array<long, D> row{};
    for (int d = 0; d < D; ++d)
      if (d != axis) row[d] = static_cast<long>(std::floor((s.soil.x[p][d] - s.grid.origin[d]) / spacing));
    rows[row].push_back(s.soil.x[p]);
  }
  SurfaceLoad<D> result;
  for (auto& [place, row] : rows) add_row<D>(s.grid, row, axis, out, spacing, result.markers);
  for (int d = 0; d < D; ++d) result.traction[d] = load.traction[d];
  result.ramp = load.ramp;
  return result;
}

template SurfaceLoad<2> make_load<2>(const Scene&, const Load&, const State<2>&);
template SurfaceLoad<3> make_load<3>(const Scene&, const Load&, const State<3>&);

}  // namespace quicksand

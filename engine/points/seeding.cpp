#include "engine/points/seeding.hpp"

#include <iterator>

#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

template <int D>
Vec<D> first(const Vec3& v) {
  Vec<D> x;
  for (int d = 0; d < D; ++d) x[d] = v[d];
  return x;
}

/// f(x) for the seeding places of a cell.
template <int D, class F>
void places(const Grid<D>& grid, const Cell<D>& c, int per_axis, F&& f) {
  std::array<int, D> k{};
  while (true) {
    Vec<D> x;
    for (int d = 0; d < D; ++d) x[d] = grid.origin[d] + (c[d] + (k[d] + 0.5) / per_axis) * grid.h;
    f(x);
    int d = 0;
    for (; d < D && ++k[d] == per_axis; ++d) k[d] = 0;
    if (d == D) return;
  }
}

/// f(x, index of the body) for every seeding place that a body covers.
template <int D, class F>
void covered_places(const Scene& scene, const Grid<D>& grid, F&& f) {
  for_each_cell(grid, [&](int, const Cell<D>& c) {
    places<D>(grid, c, scene.numerics.points_per_cell, [&](const Vec<D>& x) {
      Vec3 at{};
      for (int d = 0; d < D; ++d) at[d] = x[d];
      for (std::size_t b = 0; b < scene.bodies.size(); ++b)
        if (contains(scene.bodies[b].region, at, D)) return f(x, b);
    });
  });
}

}  // namespace

template <int D>
PointCounts count_points(const Scene& scene, const Grid<D>& grid) {
  PointCounts counts;
  covered_places<D>(scene, grid, [&](const Vec<D>&, std::size_t b) {
    const Body& body = scene.bodies[b];
    if (body.kind != BodyKind::water) ++(body.fixed ? counts.fixed : counts.soil);
    if (body.kind != BodyKind::soil) ++counts.water;
  });
  return counts;
}

template <int D>
SeededPoints<D> seed(const Scene& scene, const Grid<D>& grid) {
  SeededPoints<D> points;
  double part = grid.cell_volume();
  for (int d = 0; d < D; ++d) part /= scene.numerics.points_per_cell;
  covered_places<D>(scene, grid, [&](const Vec<D>& x, std::size_t b) {
    const Body& body = scene.bodies[b];
    const Vec<D> v = first<D>(body.velocity);
    const double share = part * grid.radius(x);
    double n = 1;
    if (body.kind != BodyKind::water) {
      const auto soil = scene.soils.find(body.soil);
      n = soil->second.porosity;
      SoilPoints<D>& set = body.fixed ? points.fixed : points.soil;
      set.add(x, body.fixed ? Vec<D>{} : v, (1 - n) * soil->second.grain_density * share,
              static_cast<int>(b));
      set.porosity.push_back(n);
      set.stress.push_back({});
      set.plastic_strain.push_back(0);
      set.soil.push_back(static_cast<int>(std::distance(scene.soils.begin(), soil)));
    }
    if (body.kind != BodyKind::soil)
      points.water.add(x, v, n * scene.water.density * share, static_cast<int>(b));
  });
  return points;
}

template PointCounts count_points<2>(const Scene&, const Grid<2>&);
template PointCounts count_points<3>(const Scene&, const Grid<3>&);
template SeededPoints<2> seed<2>(const Scene&, const Grid<2>&);
template SeededPoints<3> seed<3>(const Scene&, const Grid<3>&);

}  // namespace quicksand

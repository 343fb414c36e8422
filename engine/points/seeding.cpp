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

}  // namespace

template <int D>
SeededPoints<D> seed(const Scene& scene, const Grid<D>& grid) {
  SeededPoints<D> points;
  const int per_axis = scene.numerics.points_per_cell;
  double share = grid.cell_volume();
  for (int d = 0; d < D; ++d) share /= per_axis;
  for_each_cell(grid, [&](int, const Cell<D>& c) {
    places<D>(grid, c, per_axis, [&](const Vec<D>& x) {
      Vec3 at{};
      for (int d = 0; d < D; ++d) at[d] = x[d];
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const Body& body = scene.bodies[b];
        if (!contains(body.region, at, D)) continue;
        const Vec<D> v = first<D>(body.velocity);
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
        break;
      }
    });
  });
  return points;
}

template SeededPoints<2> seed<2>(const Scene&, const Grid<2>&);
template SeededPoints<3> seed<3>(const Scene&, const Grid<3>&);

}  // namespace quicksand

#include "engine/points/seeding.hpp"

#include <algorithm>
#include <iterator>

#include "engine/grid/walls.hpp"
#include "engine/points/blocks.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

template <int D>
Vec<D> first(const Vec3& v) {
  Vec<D> x;
  for (int d = 0; d < D; ++d) x[d] = v[d];
  return x;
}

/// Which body covers each place of the rows of places through a row of cells along x. A region is cut once
/// per row of places, so that the work does not grow with places times edges.
template <int D>
class Rows {
 public:
  Rows(const Scene& scene, const Grid<D>& grid)
      : scene_(scene),
        grid_(grid),
        per_axis_(scene.numerics.points_per_cell),
        layers_(D == 3 ? per_axis_ : 1) {
    for (const Body& body : scene.bodies) regions_.emplace_back(layers_, body.region);
    cuts_.resize(static_cast<std::size_t>(per_axis_ * layers_));
  }

  double place(int axis, int cell, int k) const {
    return grid_.origin[axis] + (cell + (k + 0.5) / per_axis_) * grid_.h;
  }

  /// Goes to the row of cells that holds c; false if no body meets it.
  bool enter(const Cell<D>& c) {
    if (D == 3 && c[D - 1] != depth_)
      for (int layer = 0; layer < layers_; ++layer)
        for (std::size_t b = 0; b < regions_.size(); ++b)
          regions_[b][layer] = at_depth(scene_.bodies[b].region, place(D - 1, c[D - 1], layer));
    depth_ = c[D - 1];
    bool any = false;
    for (int layer = 0; layer < layers_; ++layer)
      for (int k = 0; k < per_axis_; ++k) {
        auto& cut = cuts_[k + layer * per_axis_];
        cut.clear();
        for (std::size_t b = 0; b < regions_.size(); ++b) {
          Stretches s = stretches(regions_[b][layer], 0, place(1, c[1], k));
          if (!s.empty()) cut.emplace_back(b, std::move(s));
        }
        any = any || !cut.empty();
      }
    return any;
  }

  /// Calls f(x, body) for the covered places of a cell of the row, x fastest; the first body wins.
  template <class F>
  void covered(const Cell<D>& c, F&& f) const {
    for (int row = 0; row < static_cast<int>(cuts_.size()); ++row)
      for (int k = 0; !cuts_[row].empty() && k < per_axis_; ++k) {
        Vec<D> x;
        x[0] = place(0, c[0], k);
        x[1] = place(1, c[1], row % per_axis_);
        if (D == 3) x[D - 1] = place(D - 1, c[D - 1], row / per_axis_);
        const auto holds = [&](const auto& body) { return in_one_of(body.second, x[0]); };
        const auto body = std::find_if(cuts_[row].begin(), cuts_[row].end(), holds);
        if (body != cuts_[row].end()) f(x, body->first);
      }
  }

 private:
  static bool in_one_of(const Stretches& s, double x) {
    const auto after =
        std::upper_bound(s.begin(), s.end(), x, [](double v, const auto& r) { return v < r[0]; });
    return after != s.begin() && x < (*std::prev(after))[1];
  }

  const Scene& scene_;
  const Grid<D>& grid_;
  int per_axis_, layers_;
  int depth_ = -1;                            ///< layer of cells that the regions are cut at
  std::vector<std::vector<Region>> regions_;  ///< per body, per layer of places
  std::vector<std::vector<std::pair<std::size_t, Stretches>>> cuts_;  ///< per row of places: body, where
};

template <int D>
Vec<D> initial_velocity(const Body& body, const Vec<D>& x) {
  Vec<D> v = first<D>(body.velocity);
  if (body.rotation_rate == 0) return v;
  const Bounds box = bounding_box(body.region);
  v[0] -= body.rotation_rate * (x[1] - 0.5 * (box.min[1] + box.max[1]));
  v[1] += body.rotation_rate * (x[0] - 0.5 * (box.min[0] + box.max[0]));
  return v;
}

/// f(x, index of the body) for every seeding place that a body covers.
template <int D, class F>
void covered_places(const Scene& scene, const Grid<D>& grid, F&& f) {
  Rows<D> rows(scene, grid);
  bool any = false;
  for_each_cell(grid, [&](int, const Cell<D>& c) {
    if (c[0] == 0) any = rows.enter(c);
    if (any) rows.covered(c, f);
  });
}

}  // namespace

template <int D>
PointCounts count_points(const Scene& scene, const Grid<D>& grid) {
  PointCounts counts;
  Blocks<D> blocks(grid);
  BlockList list;
  covered_places<D>(scene, grid, [&](const Vec<D>& x, std::size_t b) {
    const Body& body = scene.bodies[b];
    const int cell = blocks.key_of(grid.cell_of(x));
    const bool moves = !body.fixed || body.kind != BodyKind::soil;
    if (moves && (list.key.empty() || list.key.back() != cell)) list.key.push_back(cell);
    if (body.kind != BodyKind::water) ++(body.fixed ? counts.fixed : counts.soil);
    if (body.kind != BodyKind::soil) ++counts.water;
  });
  blocks.activate({&list});
  counts.active_cells = blocks.count() * static_cast<std::size_t>(power(Blocks<D>::kEdge, D));
  return counts;
}

template <int D>
SeededPoints<D> seed(const Scene& scene, const Grid<D>& grid) {
  SeededPoints<D> points;
  double part = grid.cell_volume();
  for (int d = 0; d < D; ++d) part /= scene.numerics.points_per_cell;
  covered_places<D>(scene, grid, [&](const Vec<D>& x, std::size_t b) {
    const Body& body = scene.bodies[b];
    const Vec<D> v = initial_velocity<D>(body, x);
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

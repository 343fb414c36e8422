#include "engine/run/initial_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Height above the origin against gravity, m; 0 without gravity.
template <int D>
double elevation(const Vec<D>& gravity, const Vec<D>& x) {
  double norm = 0, along = 0;
  for (int d = 0; d < D; ++d) norm += gravity[d] * gravity[d], along -= gravity[d] * x[d];
  return norm > 0 ? along / std::sqrt(norm) : 0;
}

/// Cells of the connected water that `seed` belongs to.
template <int D>
std::vector<int> connected_water(const State<D>& s, int seed, std::vector<char>& seen) {
  std::vector<int> found{seed};
  seen[seed] = 1;
  for (std::size_t k = 0; k < found.size(); ++k)
    for (int d = 0; d < D; ++d)
      for (int side : {0, 1}) {
        const int face = found[k] + side * s.grid.stride[d],
                  other = found[k] + (2 * side - 1) * s.grid.stride[d];
        if (s.water_walls.closed(d, face) || seen[other] || !s.cell[other].wet()) continue;
        seen[other] = 1;
        found.push_back(other);
      }
  return found;
}

/// Elevation of the free surface of connected water, m; without one, the level of the highest reservoir it
/// touches, or else its own top.
template <int D>
double water_level(const State<D>& s, const std::vector<int>& cells) {
  const Vec<D>& g = s.constants.gravity;
  int up = 0;  // axis closest to gravity
  for (int d = 1; d < D; ++d)
    if (std::abs(g[d]) > std::abs(g[up])) up = d;
  const int side = g[up] > 0 ? 0 : 1;
  double surface = -std::numeric_limits<double>::infinity(), highest = surface, reservoir = surface;
  for (int i : cells) {
    const double z = elevation<D>(g, s.grid.center(s.grid.cell(i)));
    highest = std::max(highest, z + 0.5 * s.grid.h);
    for (int d = 0; d < D; ++d)
      for (int f : {i, i + s.grid.stride[d]})
        if (submerged(s, d, f))
          reservoir = std::max(reservoir, s.reservoirs[port_at(s, d, f)->reservoir].level(s.time));
    const int face = i + side * s.grid.stride[up], other = i + (2 * side - 1) * s.grid.stride[up];
    if (s.water_walls.closed(up, face) || s.cell[other].wet() || submerged(s, up, face)) continue;
    surface = std::max(surface, z + surface_distance(s.cell[i].depth, s.cell[other].depth) * s.grid.h);
  }
  return std::isfinite(surface) ? surface : std::isfinite(reservoir) ? reservoir : highest;
}

/// Whether the soil point `upper` does not rest on `lower`, the next one down its column: a gap or a wall
/// between.
template <int D>
bool carries_nothing(const State<D>& s, std::size_t upper, std::size_t lower, double spacing) {
  if (s.soil.x[upper][kUp] - s.soil.x[lower][kUp] > 1.5 * spacing) return true;
  const Cell<D> a = s.grid.cell_of(s.soil.x[upper]), b = s.grid.cell_of(s.soil.x[lower]);
  return a != b && s.soil_walls.closed(kUp, s.grid.index(a));
}

/// Vertical from the weight above, horizontal K0 times that. Columns of seeding places, each from the top
/// down.
template <int D>
void set_k0_stress(const Scene& scene, State<D>& s) {
  SoilPoints<D>& soil = s.soil;
  const double spacing = s.grid.h / scene.numerics.points_per_cell;
  const double g = -s.constants.gravity[kUp];
  const auto column = [&](std::size_t p) {
    std::array<long, D> key;
    for (int d = 0; d < D; ++d) {
      const double k = std::floor((soil.x[p][d] - s.grid.origin[d]) / spacing);
      key[d == kUp ? D - 1 : d == D - 1 ? kUp : d] = static_cast<long>(d == kUp ? -k : k);
    }
    return key;
  };
  std::vector<std::uint32_t> order(soil.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return column(a) < column(b); });

  double above = 0;  // Pa, vertical effective stress (compression) at the top of the point
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::uint32_t p = order[k];
    if (k > 0) {
      auto a = column(order[k - 1]), b = column(p);
      a[D - 1] = b[D - 1] = 0;
      if (a != b || carries_nothing(s, order[k - 1], p, spacing)) above = 0;
    }
    const SoilMaterial& m = s.constants.soils[soil.soil[p]];
    const bool wet = s.cell[s.grid.index(s.grid.cell_of(soil.x[p]))].wet();
    const double density = (1 - soil.porosity[p]) * (m.grain_density - (wet ? s.constants.water_density : 0));
    const double weight = std::max(0.0, density * g * spacing);
    const double vertical = above + 0.5 * weight;
    above += weight;
    const double k0 = m.k0 ? *m.k0 : scene.initial.k0.value_or(m.natural_k0());
    soil.stress[p] = {};
    for (int d = 0; d < 3; ++d) soil.stress[p][d] = d == kUp ? -vertical : -k0 * vertical;
  }
}

}  // namespace

template <int D>
void set_initial_pressure(const Scene& scene, State<D>& s) {
  if (scene.initial.pressure == InitialPressure::zero) return;
  double g = 0;
  for (double c : s.constants.gravity) g += c * c;
  const double weight = s.constants.water_density * std::sqrt(g);
  std::vector<char> seen(s.grid.count(), 0);
  for_each_cell(s.grid, [&](int i, const Cell<D>&) {
    if (!s.cell[i].wet() || seen[i]) return;
    const std::vector<int> cells = connected_water(s, i, seen);
    const double level = scene.initial.water_table.value_or(water_level(s, cells));
    for (int c : cells) {
      const double depth = level - elevation<D>(s.constants.gravity, s.grid.center(s.grid.cell(c)));
      s.pressure[c] = scene.initial.pressure == InitialPressure::uniform ? scene.initial.uniform_pressure
                                                                         : weight * depth;
    }
  });
}

template <int D>
void set_initial_stress(const Scene& scene, State<D>& s) {
  SoilPoints<D>& soil = s.soil;
  if (scene.initial.stress == InitialStress::k0) set_k0_stress(scene, s);
  if (scene.initial.stress == InitialStress::uniform)
    for (Stress<D>& stress : soil.stress)
      for (int i = 0; i < kStress<D>; ++i) stress[i] = scene.initial.uniform_stress[i];

  const auto& soils = s.constants.soils;
  if (std::any_of(soils.begin(), soils.end(), [](const auto& m) { return m.keeps_preconsolidation(); }))
    soil.preconsolidation.assign(soil.size(), 0);
  for (std::size_t p = 0; p < soil.size(); ++p) {
    SoilState<D> state = soil_state(soil, p);
    s.interventions.clamped_values += soils[soil.soil[p]].begin(state);
    set_soil_state(soil, p, state);
  }
}

template void set_initial_pressure<2>(const Scene&, State<2>&);
template void set_initial_pressure<3>(const Scene&, State<3>&);
template void set_initial_stress<2>(const Scene&, State<2>&);
template void set_initial_stress<3>(const Scene&, State<3>&);

}  // namespace quicksand

#pragma once
// The two sets of material points, as structures of arrays.

#include <cstdint>
#include <vector>

#include "engine/grid/grid.hpp"

namespace quicksand {

template <int D>
inline constexpr int kStress = D == 2 ? 4 : 6;  ///< xx yy zz xy [yz zx]
template <int D, class T = double>
using Stress = std::array<T, kStress<D>>;

/// What both phases' points carry.
template <int D>
struct PointSet {
  std::vector<Vec<D>> x;      ///< m
  std::vector<Vec<D>> v;      ///< m/s
  std::vector<Vec<D>> start;  ///< m, position at seeding
  std::vector<double> mass;   ///< kg
  std::vector<std::int32_t> body;
  std::vector<std::uint32_t> id;  ///< in the order in which points were made; what frames are written in
  std::uint32_t next_id = 0;
  /// 1/s, gradient of the velocity that the affine transfer carries, [component][axis]; empty otherwise
  std::vector<std::array<Vec<D>, D>> affine;
  bool carries_gradient = false;  ///< whether `affine` is kept

  std::size_t size() const { return x.size(); }
  void add(const Vec<D>& at, const Vec<D>& velocity, double m, int body_index) {
    x.push_back(at);
    v.push_back(velocity);
    start.push_back(at);
    mass.push_back(m);
    body.push_back(body_index);
    id.push_back(next_id++);
    if (carries_gradient) affine.push_back({});
  }
};

/// Body of a point that came in through the boundary.
inline constexpr std::int32_t kInflowBody = -1;

template <int D>
struct WaterPoints : PointSet<D> {};

template <int D>
struct SoilPoints : PointSet<D> {
  std::vector<double> porosity;          ///< –
  std::vector<Stress<D>> stress;         ///< Pa, effective, tension positive
  std::vector<double> plastic_strain;    ///< –, accumulated deviatoric
  std::vector<double> preconsolidation;  ///< Pa; empty unless a law of the scene keeps it
  std::vector<double> discharge;   ///< m/s, n |vw − vs| as the drag sees it; empty unless a law follows it
  std::vector<std::int32_t> soil;  ///< index of the material
};

/// Calls f(array) for every array of a set.
template <int D, class F>
void for_arrays(WaterPoints<D>& set, F&& f) {
  f(set.x), f(set.v), f(set.start), f(set.mass), f(set.body), f(set.id), f(set.affine);
}
template <int D, class F>
void for_arrays(SoilPoints<D>& set, F&& f) {
  f(set.x), f(set.v), f(set.start), f(set.mass), f(set.body), f(set.id), f(set.affine);
  f(set.porosity), f(set.stress), f(set.plastic_strain), f(set.preconsolidation), f(set.discharge),
      f(set.soil);
}

/// Removes point p; the last point takes its place. Arrays that no law of the scene keeps are empty.
template <class Set>
void erase_point(Set& set, std::size_t p) {
  for_arrays(set, [&](auto& array) {
    if (array.empty()) return;
    array[p] = array.back();
    array.pop_back();
  });
}

inline constexpr std::uint32_t kErased = 0xffffffff;
/// Removes every point p for which gone(p); the others keep their order. Returns the new index of each point
/// there was, or kErased.
template <class Set, class Gone>
std::vector<std::uint32_t> erase_points(Set& set, Gone&& gone) {
  std::vector<std::uint32_t> place(set.size());
  std::uint32_t left = 0;
  for (std::size_t p = 0; p < place.size(); ++p) place[p] = gone(p) ? kErased : left++;
  for_arrays(set, [&](auto& array) {
    if (array.empty()) return;
    for (std::size_t p = 0; p < place.size(); ++p)
      if (place[p] != kErased) array[place[p]] = array[p];
    array.resize(left);
  });
  return place;
}

}  // namespace quicksand

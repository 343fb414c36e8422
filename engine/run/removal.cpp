#include "engine/run/removal.hpp"

#include <algorithm>
#include <numeric>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Removes the points of bodies that are gone. Returns the new place of every point, kErased if it has none.
template <int D, class Set>
std::vector<std::uint32_t> remove_points(const State<D>& s, Set& set, double& mass, Vec<D>& momentum) {
  const auto gone = [&](std::size_t p) { return set.body[p] >= 0 && s.removed[set.body[p]]; };
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!gone(p)) continue;
    mass += set.mass[p];
    for (int d = 0; d < D; ++d) momentum[d] += s.constants.inertia * set.mass[p] * set.v[p][d];
  }
  return erase_points(set, gone);
}

/// Points on their way through ports, by their new places.
template <int D>
void follow_straddlers(State<D>& s, const std::vector<std::uint32_t>& place) {
  std::erase_if(s.straddlers, [&](const Straddler& q) { return place[q.point] == kErased; });
  for (Straddler& q : s.straddlers) q.point = place[q.point];
}

}  // namespace

template <int D>
Removed<D> remove_bodies(const Scene& scene, const Stage& stage, State<D>& s) {
  Removed<D> removed;
  s.removed.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (std::count(stage.remove_bodies.begin(), stage.remove_bodies.end(), scene.bodies[b].name))
      s.removed[b] = 1, removed.anything = true;
  if (!removed.anything) return removed;
  remove_points<D>(s, s.soil, removed.soil, removed.momentum);
  remove_points<D>(s, s.fixed, removed.soil, removed.momentum);
  follow_straddlers(s, remove_points<D>(s, s.water, removed.water, removed.momentum));
  for (int d = 0; d < D; ++d) s.momentum[d] -= removed.momentum[d];
  return removed;
}

template <int D>
void look_again(State<D>& s) {
  if (s.fixed.size()) measure_fixed(s);
  points_to_faces(s);
  mark_plates(s);
  find_surface(s);
}

template Removed<2> remove_bodies<2>(const Scene&, const Stage&, State<2>&);
template Removed<3> remove_bodies<3>(const Scene&, const Stage&, State<3>&);
template void look_again<2>(State<2>&);
template void look_again<3>(State<3>&);

}  // namespace quicksand

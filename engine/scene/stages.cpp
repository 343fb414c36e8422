#include "engine/scene/stages.hpp"

#include <algorithm>

namespace quicksand {
namespace {

bool names(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

bool has_water(const Scene& scene) {
  return !scene.reservoirs.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                                  [](const Body& b) { return b.kind != BodyKind::soil; });
}

bool has_soil(const Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const Body& b) { return b.kind != BodyKind::water; });
}

bool has_quasi_static(const Scene& scene) {
  return std::any_of(scene.stages.begin(), scene.stages.end(), [](const Stage& s) { return s.quasi_static; });
}

bool present(const Scene& scene, std::size_t stage, const std::string& body) {
  for (std::size_t k = 0; k <= stage; ++k)
    if (names(scene.stages[k].remove_bodies, body)) return false;
  return true;
}

bool acts(const Scene& scene, std::size_t stage, const Load& load) {
  const auto& loads = scene.stages[stage].loads;
  return present(scene, stage, load.body) && (!loads || names(*loads, load.name));
}

double head_after(const Scene& scene, std::size_t stage, const Reservoir& reservoir) {
  double head = reservoir.head;
  for (std::size_t k = 0; k <= stage; ++k)
    if (const auto found = scene.stages[k].heads.find(reservoir.name); found != scene.stages[k].heads.end())
      head = found->second;
  return head;
}

}  // namespace quicksand

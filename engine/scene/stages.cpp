#include "engine/scene/stages.hpp"

#include <algorithm>

namespace quicksand {
namespace {

bool names(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

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

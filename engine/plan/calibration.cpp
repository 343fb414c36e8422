#include "engine/plan/calibration.hpp"

#include "engine/scene/stages.hpp"

namespace quicksand {

SceneKind kind_of(const Scene& scene) {
  const bool space = scene.domain.dimension == Dimension::space;
  const bool soil = has_soil(scene), water = has_water(scene);
  if (soil && water) return space ? SceneKind::both_space : SceneKind::both;
  if (water) return space ? SceneKind::water_space : SceneKind::water;
  return space ? SceneKind::soil_space : SceneKind::soil;
}

}  // namespace quicksand

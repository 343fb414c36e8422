#pragma once
// Plane cases in other dimensions.

#include "engine/scene/scene.hpp"

namespace quicksand::test {

/// The scene of the plane extruded to 0 ≤ z ≤ depth (m) between smooth sides; its regions must be boxes.
inline Scene in_space(Scene scene, double depth) {
  scene.domain.dimension = Dimension::space;
  scene.domain.max[2] = depth;
  for (Body& body : scene.bodies) body.region.max[2] = depth;
  for (Wall& wall : scene.walls) {
    if (wall.block) wall.block->max[2] = depth;
    if (wall.line) wall.line->to[2] = depth;
  }
  for (Probe& probe : scene.output.probes) probe.at[2] = 0.5 * depth;
  return scene;
}

/// The scene of the plane turned about x = 0.
inline Scene about_axis(Scene scene) {
  scene.domain.dimension = Dimension::axisymmetric;
  return scene;
}

}  // namespace quicksand::test

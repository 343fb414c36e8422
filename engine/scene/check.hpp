#pragma once
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// Everything about the scene that a schema cannot see: names that do not exist, bodies that overlap or
/// lie in walls, walls off the cell faces, stages that do nothing. Empty when the scene can be run. All
/// faults at once.
std::vector<Fault> check(const Scene& scene);

}  // namespace quicksand

#pragma once
// The scenes that are timed, each in any size. One metre wide; more points mean smaller cells.

#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand::bench {

/// bed: saturated sand under a pond, water pressed in from below at 1.2 times the critical gradient, both
/// phases. column: dry sand, let go at once. dam: water, let go at once.
enum class Kind { bed, column, dam };

struct SceneSize {
  int dimensions = 2;
  double points = 1e5;  ///< of soil and water together, about
  int room = 1;         ///< factor on the width and on the height of the domain, the rest of it empty
};

/// Requires room 1 or 10: only the bed has a wall that holds it in a larger domain.
Scene make_scene(Kind kind, const SceneSize& size);

/// A bed or a dam whose water fills about cells × cells of the grid.
Scene make_square(Kind kind, int cells);

struct NamedKind {
  const char* name;
  Kind kind;
};
const std::vector<NamedKind>& kinds();

/// "bed2", "column3", …: kind and dimensions.
std::string scene_name(Kind kind, int dimensions);

}  // namespace quicksand::bench

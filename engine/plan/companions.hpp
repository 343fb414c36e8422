#pragma once
#include <optional>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// The same scene on other cells, for the error of its discretisation.
struct Companion {
  Scene scene;       ///< no frames but the first and last, no error estimate of its own
  double ratio = 1;  ///< –, its cells over those of the scene
};

/// The scenes that `numerics.error_estimate` asks for; each absent when no cells of another size fit the
/// walls, sides and gates (`check`) and let bodies end where they do on the scene's own cells. The nearest
/// ratio to 2 or ½ that fits is taken.
struct Companions {
  std::optional<Companion> coarser, finer;
};
Companions companions(const Scene& scene);

/// Why the error cannot be estimated; empty when it can or need not.
std::optional<Fault> no_companion(const Scene& scene);

}  // namespace quicksand

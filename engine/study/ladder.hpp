#pragma once
// The rungs of a ladder: variations of a scene whose error and cost are to be compared.

#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// One variation: one factor changed from the scene's own settings.
struct Rung {
  std::string factor, setting;  ///< "cell size", "0.05 m"
  Scene scene;
};

/// The scene itself first; those that mean nothing in it or do not fit it are left out. Cell sizes ×4 … ×½;
/// points per cell and axis 1, 3; the other kernel and transfer; a half and a quarter of the time step;
/// pressure tolerance 10⁻⁴ and 10⁻⁸; explicit or implicit pressure; Kw a tenth and a hundredth; cells of a
/// quarter last, as they cost most.
std::vector<Rung> ladder(const Scene& scene);

}  // namespace quicksand

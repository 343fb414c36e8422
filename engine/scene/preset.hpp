#pragma once
#include "engine/scene/scene.hpp"

namespace quicksand {

/// Sets every choice that a preset makes. Chosen from the measured ladders (cases/presets.md): only the cells
/// buy accuracy in every case, a factor 2 costs 8 times in the plane where the soil's wave bounds the step;
/// fewer points per cell fail where soil turns or yields (elastic bar 0.8 for 0.11, Cam-Clay 0.4 for 0.04),
/// more of them, other kernels and shorter steps cost as much as smaller cells and bring less.
void apply_preset(Preset preset, Numerics& numerics);

}  // namespace quicksand

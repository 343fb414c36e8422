#pragma once
#include "engine/plan/calibration.hpp"

namespace quicksand {

/// Runs two sizes of a small scene of each kind on one thread; a few seconds × `effort`.
Calibration calibrate(double effort = 1);

/// A square or cube of `across` cells along each side, its upper half the water if there is both, for `steps`
/// steps with `frames` frames and samples, one of them at the start. Everything moves, so that what is
/// written is no easier to pack than usual.
Scene calibration_scene(SceneKind kind, int across, long steps, int frames);

}  // namespace quicksand

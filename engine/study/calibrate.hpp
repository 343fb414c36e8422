#pragma once
#include "engine/plan/calibration.hpp"

namespace quicksand {

/// Runs two sizes of a small scene of each kind on one thread; a few seconds × `effort`.
Calibration calibrate(double effort = 1);

}  // namespace quicksand

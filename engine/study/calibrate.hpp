#pragma once
#include "engine/plan/calibration.hpp"

namespace quicksand {

/// Runs two sizes of a small scene of each kind on one thread; a few seconds.
Calibration calibrate();

}  // namespace quicksand

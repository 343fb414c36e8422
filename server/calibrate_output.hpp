#pragma once
#include "engine/plan/calibration.hpp"

namespace quicksand {

/// What a run's files cost on this machine: small runs into a temporary folder, a few seconds × `effort`.
/// `start` includes what the process has taken until now. Throws std::runtime_error if the files cannot be
/// written.
OutputCost calibrate_output(double effort = 1);

}  // namespace quicksand

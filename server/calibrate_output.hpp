#pragma once
#include <filesystem>

#include "engine/plan/calibration.hpp"

namespace quicksand {

/// What a run's files cost where results go: small runs into temporary folders in `in`, a few seconds ×
/// `effort`. `start` includes what the process has taken until now; what seeding takes is not measured.
/// Throws std::runtime_error if the files cannot be written.
OutputCost calibrate_output(const std::filesystem::path& in, double effort = 1);

}  // namespace quicksand

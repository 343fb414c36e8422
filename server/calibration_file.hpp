#pragma once
#include <filesystem>
#include <string>

#include "engine/plan/calibration.hpp"

namespace quicksand {

/// `$XDG_CACHE_HOME/quicksand/calibration.json` or under `~/.cache`: for the command line.
std::filesystem::path user_calibration();
/// `calibration.json` in a service's state folder.
std::filesystem::path state_calibration(const std::filesystem::path& state);

std::string calibration_json(const Calibration& calibration);
/// The built-in one when the file is absent or cannot be read.
Calibration read_calibration(const std::filesystem::path& file);

}  // namespace quicksand

#pragma once
// Numerics::target_error and budget_seconds: which preset and cells they ask for.

#include <functional>
#include <optional>

#include "engine/plan/calibration.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

/// A fault if no cells give what is asked for.
struct SettingsChoice {
  std::optional<Scene> scene;  ///< with its cells and the reason in Numerics::chosen
  std::optional<Fault> fault;
};

/// target_error: the largest cells whose expected error is no more. budget_seconds: the smallest whose
/// estimated time is no more. Both: as target_error, refused if it costs more. Cells between 4 and 1/4 of
/// domain.cell_size are tried, those on which check() finds no fault. `with_preset` is the scene under one
/// preset; the nearest to the cells decides on all else. Requires one of the two to be given.
SettingsChoice choose_settings(const std::function<Scene(Preset)>& with_preset, const Calibration& machine);

}  // namespace quicksand

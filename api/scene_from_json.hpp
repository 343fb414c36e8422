#pragma once
#include <optional>

#include "api/place.hpp"

namespace quicksand {

/// The scene that the document describes, as far as it can be read: refused values keep their defaults, a
/// region with a fault holds nothing, and with a fault in the grid `domain.cell_size` is 0. Adds faults that
/// depend on the dimension. `preset` replaces the document's own.
Scene scene_from_json(const nlohmann::json& document, const std::optional<Preset>& preset, Reading& reading);

}  // namespace quicksand

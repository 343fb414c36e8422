#pragma once
#include <nlohmann/json.hpp>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// The scene as a document of `quicksand.case/1` with every value written that has an effect, defaults and
/// preset choices included. Reading it gives the same scene.
nlohmann::ordered_json scene_to_json(const Scene& scene);

}  // namespace quicksand

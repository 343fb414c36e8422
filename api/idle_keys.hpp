#pragma once
#include "api/place.hpp"

namespace quicksand {

/// Adds a fault for every key that is given but, by a choice made elsewhere in the case, has no effect, and
/// for every key that such a choice makes necessary but that is absent. A scene's values cannot show this: it
/// takes the document, which knows what was given.
void check_choices(const nlohmann::json& document, const Scene& scene, Reading& reading);

}  // namespace quicksand

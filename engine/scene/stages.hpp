#pragma once
// What a scene holds, and what holds in a stage by what it and the stages before it say.

#include <string>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// Whether water comes with a body or from a reservoir.
bool has_water(const Scene& scene);
bool has_soil(const Scene& scene);
bool has_quasi_static(const Scene& scene);

/// Whether the body is still there in a stage.
bool present(const Scene& scene, std::size_t stage, const std::string& body);
/// Whether the load acts in a stage.
bool acts(const Scene& scene, std::size_t stage, const Load& load);
/// Level of a reservoir at the end of a stage, m.
double head_after(const Scene& scene, std::size_t stage, const Reservoir& reservoir);

}  // namespace quicksand

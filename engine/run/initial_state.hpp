#pragma once
#include "engine/scene/scene.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// Pore pressure of still water: in each connected body of water from its own highest free surface (its
/// highest cell if it has none). Requires find_surface.
template <int D>
void set_initial_pressure(const Scene& scene, State<D>& state);

/// Effective stress of soil at rest under its own weight (buoyant where wet), column by column of points;
/// horizontal stress K0 times the vertical.
template <int D>
void set_initial_stress(const Scene& scene, State<D>& state);

}  // namespace quicksand

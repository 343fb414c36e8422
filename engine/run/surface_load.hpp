#pragma once
#include "engine/scene/scene.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// The load on one side of a body: markers at the points of the layer below that side, row by row inward from
/// the outermost point of each row, whose half spacing ends at the surface.
template <int D>
SurfaceLoad<D> make_load(const Scene& scene, const Load& load, const State<D>& s);

}  // namespace quicksand

#pragma once
#include "engine/scene/scene.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// State of a scene at time 0: points, walls of the first stage, initial pressure and stress.
template <int D>
State<D> make_state(const Scene& scene);

/// Walls, gates and ports of a stage, with what was removed until then.
template <int D>
void set_walls(const Scene& scene, const Stage& stage, State<D>& state);
/// Step limits of the soils for the inertia that holds now.
template <int D>
void scale_limits(State<D>& state);

/// Opens and closes gates, switches loads, and sets levels and damping for a stage.
template <int D>
void enter_stage(const Scene& scene, const Stage& stage, State<D>& state);

}  // namespace quicksand

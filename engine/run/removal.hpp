#pragma once
// Bodies that a stage takes away.

#include "engine/scene/scene.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// What left with removed bodies.
template <int D>
struct Removed {
  double water = 0, soil = 0;  ///< kg
  Vec<D> momentum{};           ///< N·s, × inertia
  bool anything = false;
};

/// Takes the points of the bodies that `stage` removes out of the state, wherever they are by now: grains,
/// moving or fixed, and water, free or between the grains. Water that came in through a reservoir belongs to
/// no body and stays. Walls, loads and the grid's fields follow in `enter_stage` and `look_again`.
template <int D>
Removed<D> remove_bodies(const Scene& scene, const Stage& stage, State<D>& state);

/// Sums, plates, surface and pressure of the points that are left, for what is asked before the next step.
template <int D>
void look_again(State<D>& state);

}  // namespace quicksand

#pragma once
#include "engine/step/phases.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// Step limits of the soil, before a step has told them.
template <int D>
void limits_before_first_step(const State<D>& state, StepReport<D>& report);

}  // namespace quicksand

#pragma once
// Why a run ended before its time, in plain words: when, where, which phase, likely cause, what to change.

#include "engine/run/run.hpp"
#include "engine/run/soundness.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

// `shortened`: to which part of the step that bounds allow the step had been shortened, to no avail.

template <int D>
Failure not_finite(const Scene& scene, const State<D>& state, double shortened = 1);
template <int D>
Failure collapsed_step(const Scene& scene, const State<D>& state, const StepBound& bound,
                       double shortened = 1);
template <int D>
Failure pressure_not_found(const Scene& scene, const State<D>& state, double residual, double shortened = 1);
template <int D>
Failure unsound(const Scene& scene, const State<D>& state, const Unsound& what, double shortened);
/// Only a fixed numerics.time_step can be above the stability bound.
template <int D>
Failure unstable_step(const Scene& scene, const State<D>& state, const StepBound& wave);
Failure too_many_steps(const Scene& scene, double time);

}  // namespace quicksand

#pragma once
// Steps end on frames, samples and ends of stages.

#include <cmath>

#include "engine/run/time_rounding.hpp"

namespace quicksand {

/// The first multiple of `interval` after `last`, s.
inline double next_event(double last, double interval) {
  return (std::floor(last / interval + kTimeRounding) + 1) * interval;
}

/// A step of `dt` from `now`, shortened so that it ends on `event`; two equal steps rather than a sliver.
inline double until(double event, double now, double dt) {
  const double rest = event - now;
  if (rest <= dt * (1 + kTimeRounding)) return rest;
  return rest < 2 * dt ? 0.5 * rest : dt;
}

}  // namespace quicksand

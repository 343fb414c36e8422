#include "engine/run/outputs.hpp"

#include <algorithm>
#include <cmath>

#include "engine/run/time_rounding.hpp"

namespace quicksand {
namespace {

double next_event(double last, double interval) {
  return (std::floor(last / interval + kTimeRounding) + 1) * interval;
}

}  // namespace

bool Outputs::due(double time, double last, double interval) {
  return time >= next_event(last, interval) - kTimeRounding * interval;
}

double Outputs::until_event(double now, double dt, double stage_end) const {
  const double frame = next_event(last_frame_, wanted_.frame_interval),
               sample = next_event(last_sample_, wanted_.series_interval);
  const double rest = std::min({stage_end, frame, sample}) - now;
  if (rest <= dt * (1 + kTimeRounding)) return rest;
  return rest < 2 * dt ? 0.5 * rest : dt;
}

}  // namespace quicksand

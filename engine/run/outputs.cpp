#include "engine/run/outputs.hpp"

#include <algorithm>

#include "engine/run/event_times.hpp"

namespace quicksand {

bool Outputs::due(double time, double last, double interval) {
  return time >= next_event(last, interval) - kTimeRounding * interval;
}

double Outputs::until_event(double now, double dt, double stage_end) const {
  const double frame = next_event(last_frame_, wanted_.frame_interval),
               sample = next_event(last_sample_, wanted_.series_interval);
  return until(std::min({stage_end, frame, sample}), now, dt);
}

}  // namespace quicksand

#pragma once
// Frames whose every number follows from its place, so that any reader can check any of them. The same
// formula stands in known_frames.py.

#include <cstddef>
#include <string>
#include <vector>

#include "engine/run/run.hpp"

namespace quicksand::known {

/// Points of each frame: growing, shrinking, none, and more than one chunk holds.
inline constexpr std::size_t points[] = {1000, 1200, 0, 900, 70001};
inline constexpr std::size_t frames = std::size(points);

/// Component `c` of point `i` in frame `k`. Exact in float32.
inline float value(std::size_t k, std::size_t i, int c) {
  return static_cast<float>(16 * (i % 4096) + 4 * k) + 0.25F * static_cast<float>(c);
}

inline std::vector<SeriesInfo> series() {
  return {{"probe.below", "Pa", 1}, {"section.pipe", "m/s", 3}, {"ledger.water_volume", "m³", 1}};
}

/// Time of frame `k` in seconds; not representable exactly, as in a run.
inline double time(std::size_t k) { return 0.1 * static_cast<double>(k); }

inline Frame frame(std::size_t k, std::size_t count) {
  Frame frame;
  frame.index = k;
  frame.time = time(k);
  frame.stage = k < 2 ? "at rest" : "valve open";
  frame.fields = {{"displacement", "m", 3, {}},
                  {"pore_pressure", "Pa", 1, {}},
                  {"effective_stress", "Pa", 4, {}},
                  {"strain", "–", 6, {}}};
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < 3; ++c) frame.position.push_back(1e-3 * (value(k, i, c) + 1.0 / 3.0));
    frame.phase.push_back(static_cast<std::uint8_t>(i % 2));
    frame.body.push_back(static_cast<std::int32_t>(i % 3));
    for (FrameField& field : frame.fields)
      for (int c = 0; c < field.components; ++c) field.values.push_back(value(k, i, c));
  }
  return frame;
}
inline Frame frame(std::size_t k) { return frame(k, points[k]); }

/// Sample number `s`: one value, three, one.
inline std::vector<double> sample(std::size_t s) {
  const double x = static_cast<double>(s);
  return {x, x + 0.1, x + 0.2, x + 0.3, -x};
}

}  // namespace quicksand::known

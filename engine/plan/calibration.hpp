#pragma once
// How long steps take on a machine.

#include <array>
#include <cstddef>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// What the program runs for a scene; each has loops of its own.
enum class SceneKind { soil, water, both, soil_space, water_space, both_space };
inline constexpr std::size_t kSceneKinds = 6;
SceneKind kind_of(const Scene& scene);

/// A step takes `step + point · points` seconds on one core.
struct StepCost {
  double step = 0, point = 0;  ///< s
};

/// What a run takes besides its steps, s: opening and closing its file, seeding a point, a frame without
/// fields and a point in it, each of its fields and a component of it at a point, and making sure that what
/// was written is on the disk.
struct OutputCost {
  double start = 0.03, seed_point = 1e-6, frame = 0.8e-3, frame_point = 0.5e-6, field = 0.13e-3,
         component = 0.06e-6, flush = 1e-3;
};

struct Calibration {
  /// By SceneKind; the defaults are those of one 2.6 GHz core (tests/bench/run, `quicksand calibrate`).
  std::array<StepCost, kSceneKinds> cost{
      {{8e-6, 125e-9}, {8e-6, 120e-9}, {17e-6, 135e-9}, {30e-6, 275e-9}, {15e-6, 215e-9}, {27e-6, 275e-9}}};
  OutputCost output;
  double seconds(const Scene& scene, double steps, double points) const {
    const StepCost& c = cost[static_cast<std::size_t>(kind_of(scene))];
    return steps * (c.step + c.point * points);
  }
};

}  // namespace quicksand

#pragma once
#include <cstddef>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// How slow a stage is beside the waves in its soil. Of the moving soil that is there, with layers of
/// thickness h_i (each body's share of the soil's height H) as if water and waves passed one after the other:
///   process time   min(stage duration, ρw g Σ(h_i/k_i) Σ h_i (1/Ec_i + n_i/Kw))
///                  H²/c_v of a uniform soil
///   transit time   (L/H) Σ h_i √((1−n_i) ρs_i/Ec_i)                     the dry frame's wave
/// or a tenth of the pore water's own, √(ρw/Kw), where that is longer
/// with L the soil's largest extent, across which stresses must even out. Dry soil has no time but the
/// stage's.
struct SlowProcess {
  double process_time = 0;  ///< s
  double transit_time = 0;  ///< s, with true inertia
  /// –, ≥ 1: what inertia is multiplied by in a quasi-static stage, so that a wave still crosses the soil
  /// `numerics.quasi_static_transits` times within the process time; accelerations are then about
  /// 1/transits² of what drives the process. 1 in all other stages.
  double inertia = 1;
};

SlowProcess slow_process(const Scene& scene, std::size_t stage);

/// Transits of the pore water's own wave that count as one of the frame's: drag damps it, so that N of them
/// leave an error of 1/N², 0.25 % at 20; the frame's goes on to and fro.
inline constexpr double kWaterTransits = 0.1;
/// Part of the strain energy that the kinetic energy, with its scaled inertia, may reach before an answer
/// says that its inertia is not negligible.
inline constexpr double kNegligibleInertia = 0.01;
/// Part of the process time at the start of a stage in which the waves of loads that were just applied are
/// not counted: 20 of 200 transits.
inline constexpr double kSettlingPart = 0.1;

}  // namespace quicksand

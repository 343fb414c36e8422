#pragma once
// Local damping, for stages that only look for the state at rest.

#include <algorithm>
#include <cmath>

namespace quicksand {

/// Local non-viscous damping: of the out-of-balance force F of a face and a phase, the part α is turned
/// against the velocity v (P. A. Cundall, Distinct element models of rock and soil structure, 1987),
///      M dv/dt = F − α |F| sign(v),
/// so that what speeds up does so with (1−α) F and what slows down with (1+α) F. F holds everything that acts
/// on the phase: effective stress, pressure, weight, viscosity and drag. Where the process is slow it is
/// next to nothing, so that seepage and consolidation keep their pace.
///
/// Written as F with an inertia of M/f, where f is what is left of the change of velocity: the pressure and
/// the drag, which are solved for, then belong to F as they are at the end of the step.
///
/// `change` is the change of velocity that F would make in the step. Damping stops and never turns: as far as
/// F itself turns the motion, f gives way down to 1−α. With Cundall's own sign(v) a lattice that swings with
/// nearly the largest stable step would be driven, with this rule it is damped at any step that is stable
/// without.
inline double damped_part(double alpha, double velocity, double change) {
  if (velocity * change >= 0) return 1 - alpha;
  return std::clamp(std::abs(velocity / change), 1 - alpha, 1 + alpha);
}

}  // namespace quicksand

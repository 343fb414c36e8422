#pragma once
#include "engine/step/conjugate_gradients.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// Pressure at the end of the step from the mass balance of the mixture, per wet cell
///      n/(Kw Δt) (p − pⁿ) = −∇·q + drift,   q = q̂ − β ∇p,
/// [FMS19] eq. (3) with the convective term that the print leaves out (∇·q contains it) and p implicit.
/// `drift` feeds back the volume that cells hold too much or too little, slowly: [FMS19] eq. (5).
/// Solved by conjugate gradients from the last pressure, preconditioned by multigrid, until the largest
/// residual is below `tolerance` × the largest right-hand side — what one step of unbalanced weight would
/// compress. Same bits for any number of threads.
///
/// With the pressure explicit, [FMS19]'s scheme, the same balance with pⁿ in q:
///      p = pⁿ − Δt Kw/n (∇·q − drift),   q = q̂ − β ∇pⁿ.
/// At the water surface, which may lie as near to a cell's centre as `kMinSurfaceDistance`, the flux answers
/// to p itself: cut cells then do not bound the step, and the row stays one division.
template <int D>
PressureReport solve_pressure(State<D>& s, double dt);

}  // namespace quicksand

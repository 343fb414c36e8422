#pragma once
#include "engine/step/multigrid.hpp"
#include "engine/step/pressure_system.hpp"

namespace quicksand {

struct PressureReport {
  int unknowns = 0;
  int iterations = 0;
  double residual = 0;  ///< largest |residual| over largest |right-hand side|
  bool converged = true;
};

/// y = A x, pistons included.
template <int D>
void multiply(const PressureSystem<D>& m, const std::vector<double>& x, std::vector<double>& y);

/// Conjugate gradients on `m` from `m.solution`, first along `m.change` unless that is empty, then
/// preconditioned by one cycle of `multigrid`, until the largest residual is below `tolerance` × the largest
/// right-hand side or what rounding leaves.
template <int D>
PressureReport conjugate_gradients(const Grid<D>& grid, PressureSystem<D>& m, Multigrid<D>& multigrid,
                                   double tolerance);

}  // namespace quicksand

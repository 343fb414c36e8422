#pragma once
#include <array>
#include <vector>

namespace quicksand {

/// Symmetric positive definite system on the wet cells, one entry per row for each upper neighbour.
template <int D>
struct PressureSystem {
  std::vector<int> cell;                        ///< row → cell, block by block
  std::vector<double> diagonal, rhs, solution;  ///< 1/(Pa·s), 1/s, Pa
  std::vector<double> change;                   ///< Pa, in which direction the solution is looked for first
  std::array<std::vector<int>, D> upper;        ///< row of the neighbour in +d, or −1
  std::array<std::vector<int>, D> lower;        ///< row of the neighbour in −d, or −1
  std::array<std::vector<double>, D> coupling;  ///< ≤ 0, to the upper neighbour

  /// What moves as one against the pressure of many cells: `response` b bᵀ on the rows.
  struct Piston {
    double response = 0;         ///< 1/(Pa·s) per weight²
    std::vector<int> cell, row;  ///< rows are numbered with the system
    std::vector<double> weight;  ///< b: ±1, times the radius about an axis
  };
  std::vector<Piston> pistons;

  /// Vectors of the solution, each one longer than the rows; kept, as a system is solved in every step.
  struct Work {
    std::vector<double> x, residual, preconditioned, direction, image;
  };
  Work work;

  static constexpr double kBytesPerRow = (9 + D) * sizeof(double) + (1 + 2 * D) * sizeof(int);
};

}  // namespace quicksand

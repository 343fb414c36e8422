#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace quicksand {

/// Room for n entries and an eighth: what grows by a few from step to step would double by itself.
template <class T>
void resize_with_spare(std::vector<T>& v, std::size_t n) {
  if (n > v.capacity()) v.reserve(n + n / 8);
  v.resize(n);
}

/// Rows diagonal·x − Σ coupling·x[neighbour], member by member. Sides of a cell: 2d below it along axis d,
/// 2d + 1 above it.
template <int D>
struct Stencil {
  std::vector<double> diagonal;
  std::array<std::vector<double>, 2 * D> coupling;  ///< ≥ 0; 0 where there is no neighbour

  void resize(std::size_t rows) {
    resize_with_spare(diagonal, rows);
    for (auto& side : coupling) resize_with_spare(side, rows);
  }
};

/// Symmetric positive definite system on the wet cells. Those come first whose coordinates add up to an even
/// number, then the others, both line by line along x: so the neighbours of consecutive rows are consecutive.
template <int D>
struct PressureSystem {
  std::vector<int> cell;                         ///< row → cell
  int even = 0;                                  ///< rows that come first
  Stencil<D> matrix;                             ///< 1/(Pa·s)
  std::array<std::vector<int>, 2 * D> neighbor;  ///< row beyond a side, or −1
  bool changed = true;                           ///< `cell` or `neighbor` since the last solution
  std::vector<double> rhs, solution;             ///< 1/s, Pa
  std::vector<double> change;                    ///< Pa, in which direction the solution is looked for first

  /// What moves as one against the pressure of many cells: `response` b bᵀ on the rows.
  struct Piston {
    double response = 0;         ///< 1/(Pa·s) per weight²
    std::vector<int> cell, row;  ///< rows are numbered with the system
    std::vector<double> weight;  ///< b: ±1, times the radius about an axis
  };
  std::vector<Piston> pistons;

  /// Vectors of the solution; kept, as a system is solved in every step.
  struct Work {
    std::vector<double> residual, preconditioned, direction, image;
  };
  Work work;

  void resize() {
    const std::size_t rows = cell.size();
    changed = changed || rhs.size() != rows;
    matrix.resize(rows);
    for (auto& side : neighbor) resize_with_spare(side, rows);
    for (auto* v : {&rhs, &solution, &change}) resize_with_spare(*v, rows);
  }
  static constexpr double kBytesPerRow = (8 + 2 * D) * sizeof(double) + (1 + 2 * D) * sizeof(int);
};

}  // namespace quicksand

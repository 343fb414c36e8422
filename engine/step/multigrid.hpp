#pragma once
// Multigrid on the wet cells, one V-cycle as preconditioner of conjugate gradients: its iterations do not
// grow with the grid.
//
// A coarse row stands for the 2^D cells of a cube. Restriction adds their rows up, prolongation copies, both
// of order one. So the coarse cells are cells of the same kind, twice as large: their coupling is the flux
// through the common face, Σ β h^(D−1) over twice the distance, half of what the sum PᵀAP gives. Storage and
// the water surface's own terms add up. Smoothing is Gauss–Seidel in two colours, forward before and backward
// after, so that the cycle is symmetric; colours and sums do not depend on the number of threads.

#include <array>
#include <vector>

#include "engine/grid/grid.hpp"
#include "engine/step/pressure_system.hpp"

namespace quicksand {

template <int D>
class Multigrid {
 public:
  /// Coefficients of `m`; the levels' structure is kept while the wet cells stay the same.
  void build(const Grid<D>& grid, const PressureSystem<D>& m);
  /// out = one V-cycle on A out = in, from zero. Not const: works in the levels' own vectors.
  void apply(const std::vector<double>& in, std::vector<double>& out);
  /// y = A x of the finest level.
  void multiply(const std::vector<double>& x, std::vector<double>& y) const;
  std::size_t levels() const { return levels_.size(); }
  /// What the levels take, bytes; and about as much of a wet cell before there are any.
  double bytes() const;
  static constexpr double bytes_per_row() {
    const double row = sizeof(int) + sizeof(Row) + sizeof(Cell<D>) + 2 * sizeof(int) + 2 * sizeof(double);
    return row * kChildren / (kChildren - 1) + kChildren * sizeof(int) / (kChildren - 1.0);
  }

 private:
  static constexpr int kSides = 2 * D, kChildren = 1 << D;
  /// diagonal·x − Σ beta·x[neighbour] = b. Neighbours that are not there point at the row behind the last,
  /// where x is zero.
  struct Row {
    double diagonal = 0, inverse = 0;
    std::array<double, kSides> beta{};
    std::array<int, kSides> neighbor{};
  };
  struct Level {
    std::vector<Row> rows;
    std::vector<Cell<D>> place;                        ///< of the row's cell on its own lattice
    std::array<std::vector<int>, 2> colored;           ///< rows by the parity of their place
    std::vector<int> parent;                           ///< row of the next level
    std::vector<std::array<int, kChildren>> children;  ///< rows of the level before; −1: none
    std::vector<double> x, b;                          ///< x one longer than rows
  };

  void build_structure(const Grid<D>& grid, const PressureSystem<D>& m);
  void finish_level(Level& level);
  void coarsen(Level& fine, Level& coarse);
  void fill_coarse(const Level& fine, Level& coarse);
  void relax(Level& level, int color, bool from_zero);
  void cycle(std::size_t k);

  std::vector<Level> levels_;
  std::vector<int> cells_;  ///< of the structure
};

extern template class Multigrid<2>;
extern template class Multigrid<3>;

}  // namespace quicksand

#pragma once
// Multigrid on the wet cells, one cycle as preconditioner of conjugate gradients: its iterations do not grow
// with the grid. The finest level is gone through once, large coarse ones twice.
//
// A coarse row stands for the 2^D cells of a cube. Restriction adds their rows up, prolongation copies, both
// of order one. So the coarse cells are cells of the same kind, twice as large: their coupling is the flux
// through the common face, Σ β h^(D−1) over twice the distance, half of what the sum PᵀAP gives. Storage and
// the water surface's own terms add up. Smoothing is Gauss–Seidel in two colours, forward before and backward
// after, so that the cycle is symmetric; colours and sums do not depend on the number of threads.
//
// Rows of a colour follow each other line by line, so that the neighbours of a run of rows are runs of rows,
// and loops along runs work on several rows at once.

#include <array>
#include <vector>

#include "engine/grid/grid.hpp"
#include "engine/step/pressure_system.hpp"

namespace quicksand {

template <int D>
class Multigrid {
 public:
  /// Coefficients of `m`, which has to stay while they are used; the levels' structure is that of before
  /// unless `m.changed`.
  void build(const Grid<D>& grid, const PressureSystem<D>& m);
  /// out = one cycle on A out = in, from zero; returns in·out. Not const: works in the levels' own vectors,
  /// and `in` is theirs meanwhile.
  double apply(std::vector<double>& in, std::vector<double>& out);
  /// y = A x of the finest level; returns x·y.
  double multiply(const std::vector<double>& x, std::vector<double>& y) const;
  std::size_t levels() const { return levels_.size(); }
  /// What the levels take, bytes; and about as much of a wet cell before there are any.
  double bytes() const;
  static constexpr double bytes_per_row() {
    constexpr double coarse = 1.0 / (kChildren - 1);  // rows of all coarse levels to one of the finest
    constexpr double vectors = 3.5 * sizeof(double) + sizeof(int);  // x, b, inverse, half of left; parent
    constexpr double stencil = (1 + kSides) * sizeof(double) + kChildren * sizeof(int);
    return vectors * (1 + coarse) + stencil * coarse;
  }

 private:
  static constexpr int kSides = 2 * D, kChildren = 1 << D;
  /// Consecutive rows of one colour whose neighbours on each side are consecutive, too.
  struct Run {
    int first = 0, count = 0;
    std::array<int, kSides> neighbor{};  ///< of the first row; itself where there is none, with coupling 0
  };
  struct Level {
    const Stencil<D>* matrix = nullptr;
    Stencil<D> own;                                    ///< of a coarse level
    std::vector<double> inverse;                       ///< of the diagonal
    int even = 0;                                      ///< rows of the first colour
    std::vector<Run> runs;                             ///< of even rows, then of odd ones
    std::vector<int> parts;                            ///< run that begins a part of some rows; the end
    int odd_part = 0;                                  ///< the first part of odd rows
    std::vector<int> parent;                           ///< row of the next level
    std::vector<std::array<int, kChildren>> children;  ///< rows of the level before; −1: none
    std::vector<double> x, b, left;                    ///< left: b − A x of the even rows
    std::size_t rows() const { return inverse.size(); }
  };
  using Neighbors = std::array<std::vector<int>, kSides>;

  void build_structure(const Grid<D>& grid, const PressureSystem<D>& m);
  void find_runs(Level& level, const Neighbors& neighbor);
  Neighbors coarsen(Level& fine, Level& coarse, std::vector<Cell<D>>& place);
  void fill_coarse(const Level& fine, Level& coarse);
  template <class F>
  static void for_runs(const Level& level, int color, F&& f);
  template <class F>
  static double sum_runs(const Level& level, F&& f);
  void relax(Level& level, int color);
  void start(Level& level, std::size_t begin, std::size_t end);
  void restrict_to(Level& coarse, Level& fine);
  void solve_last(Level& level);
  void cycle(std::size_t k);

  std::vector<Level> levels_;
};

extern template class Multigrid<2>;
extern template class Multigrid<3>;

}  // namespace quicksand

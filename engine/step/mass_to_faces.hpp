#pragma once
// Points of either phase → faces: mass and momentum.

#include "engine/grid/window_rows.hpp"
#include "engine/step/batches.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// kg·m/s per cell along each axis, of component d; zeros without the affine transfer.
template <class S, int d, int D>
QUICKSAND_INLINE std::array<BatchLanes, D> turning_of(const PointSet<D>& set, const PointBatch<D>& batch,
                                                      const BatchLanes& mass, double h) {
  std::array<BatchLanes, D> turning{};
  if constexpr (S::affine)
    for (int j = 0; j < D; ++j)
      turning[j] = h * mass * lanes_of<kBatch>([&](int k) { return set.affine[batch.point[k]][d][j]; });
  return turning;
}

/// What goes with the rows of component d's window, and with the points along x. With the affine transfer
/// momentum by the arms: [JSSTS15] eq. (8), per component of the staggered grid.
template <class S, int d, int D>
struct MassRows {
  static constexpr int kRows = WindowRows<d, D>::count;
  RowFactors<kRows> weight, turned;  ///< –; kg·m/s by the arms across, affine only
  PairsByPoint pair;                 ///< kg, kg·m/s
  Kept<> at, turning;                ///< affine only: along x

  template <class Kernel>
  QUICKSAND_INLINE MassRows(const Kernel& kernel, const BatchLanes& mass, const BatchLanes& v,
                            const std::array<BatchLanes, D>& by_arm)
      : weight(row_weights<d, D>(kernel)), pair(mass, mass * v) {
    if constexpr (S::affine) {
      const auto& second = nodes_along<d, 1>(kernel);
      const auto& third = nodes_along<d, D - 1>(kernel);
      for_rows<d, D>([&](auto r, auto y, auto z) __attribute__((always_inline)) {
        BatchLanes across = by_arm[1] * second.arm(y);
        if constexpr (D == 3) across += by_arm[2] * third.arm(z);
        turned[r] = across * weight[r].lanes();
      });
      at = nodes_along<d, 0>(kernel).at, turning = by_arm[0];
    }
  }
  /// Of the points `from` to `to`, whose weights along x are `nodes`.
  QUICKSAND_INLINE RowSums<kRows> sums(const NodesByPoint<2>& nodes, int from, int to) const {
    const auto carried = [&](int k) __attribute__((always_inline)) {
      Lanes<8> along = pair[k];
      if constexpr (S::affine) along += second_of_pairs(turning[k]) * (node_numbers() - at[k]);
      return nodes[k] * along;
    };
    const auto by_arm = [&](int k) __attribute__((always_inline)) { return nodes[k] * second_of_pairs(1); };
    if constexpr (S::affine)
      return sum_points<2>(from, to, Term(weight, carried), Term(turned, by_arm));
    else
      return sum_points<2>(from, to, Term(weight, carried));
  }
};

}  // namespace quicksand

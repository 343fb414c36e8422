#pragma once
// How far an answer is from that of infinitely small cells, by Richardson's extrapolation: with f(h) = f(0) +
// C hᵖ, two grids and an order, or three grids, give f(h) − f(0). Roache, Verification and Validation in
// Computational Science and Engineering (1998), chapter 5.

#include <optional>

namespace quicksand {

/// Order that two grids are read with. Errors of orders between 0.7 and 2.7 on a doubled grid then lie within
/// a factor 3 of the estimate.
inline constexpr double kAssumedOrder = 1.5;
/// Observed orders outside are not those of a discretisation that converges.
inline constexpr double kLowestOrder = 0.5, kHighestOrder = 4;

/// What is known of one figure: |difference| to the answer on coarser and finer cells, their ratio to the
/// answer's.
struct GridDifference {
  double difference = 0;
  double ratio = 1;  ///< –, above 1 coarser, below 1 finer
};

enum class OrderBasis { assumed, observed, not_asymptotic };
struct DiscretisationError {
  double error = 0;  ///< ≥ 0, of the answer
  double order = kAssumedOrder;
  OrderBasis basis = OrderBasis::assumed;
};

/// One of the two must be given. `same_sign` says whether both differences go the same way as the cells
/// shrink; if not, or if no order between the bounds fits, the figure is not in the asymptotic range and the
/// error is the larger of what both differences say with order 1: an honest bound rather than an
/// extrapolation.
DiscretisationError richardson(const std::optional<GridDifference>& coarser,
                               const std::optional<GridDifference>& finer, bool same_sign = true);

}  // namespace quicksand

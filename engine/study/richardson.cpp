#include "engine/study/richardson.hpp"

#include <algorithm>
#include <cmath>

namespace quicksand {
namespace {

/// Error of the answer if its difference to a grid `ratio` times as coarse (or fine) is known.
double extrapolated(const GridDifference& d, double order) {
  return d.difference / std::abs(std::pow(d.ratio, order) - 1);
}

/// Coarser over finer difference that an order gives; it grows with the order.
double quotient(double coarser, double finer, double order) {
  return (std::pow(coarser, order) - 1) / (1 - std::pow(finer, order));
}

}  // namespace

DiscretisationError richardson(const std::optional<GridDifference>& coarser,
                               const std::optional<GridDifference>& finer, bool same_sign) {
  if (!coarser || !finer) return {extrapolated(coarser ? *coarser : *finer, kAssumedOrder)};
  if (coarser->difference == 0 && finer->difference == 0) return {};
  const double found = coarser->difference / finer->difference;
  double low = kLowestOrder, high = kHighestOrder;
  const bool within = found >= quotient(coarser->ratio, finer->ratio, low) &&
                      found <= quotient(coarser->ratio, finer->ratio, high);
  if (!same_sign || !within)
    return {std::max(extrapolated(*coarser, 1), extrapolated(*finer, 1)), 1, OrderBasis::not_asymptotic};
  constexpr int halvings = 40;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (quotient(coarser->ratio, finer->ratio, middle) < found ? low : high) = middle;
  }
  return {extrapolated(*finer, low), low, OrderBasis::observed};
}

}  // namespace quicksand

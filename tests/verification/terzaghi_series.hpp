#pragma once
#include <cmath>
#include <numbers>

namespace quicksand::test {

/// K. Terzaghi's excess pressure over that at the start, Σ 2/M sin(M z) exp(−M² T) with M = (2m + 1) π/2: at
/// the depth z below the drained end, of the way of drainage, and the dimensionless time T.
inline double terzaghi_pressure(double time, double z) {
  double sum = 0;
  for (int m = 0; m < 200; ++m) {
    const double a = (2 * m + 1) * std::numbers::pi / 2;
    sum += 2 / a * std::sin(a * z) * std::exp(-a * a * time);
  }
  return sum;
}

}  // namespace quicksand::test

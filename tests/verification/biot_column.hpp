#pragma once
// Waves in a saturated column, solved independently of the engine: M. A. Biot's equations of grains and water
// in one dimension (velocities of both, no u-p shortcut) by central differences on a fine staggered lattice.

#include <cmath>
#include <vector>

namespace quicksand::test {

struct BiotColumn {
  double height, modulus, porosity, grain_density, water_density, bulk_modulus;  ///< m, Pa, –, kg/m³, Pa
  double drag;                                                                   ///< N·s/m⁴, n² ρw g/k
  double load, ramp;  ///< Pa, s: on the grains at the top, where the pressure is zero
};

/// At one depth, over time.
struct BiotHistory {
  std::vector<double> time, pressure, grains, water;  ///< s, Pa, m/s (downwards)
};

/// Speeds of the fast and the slow wave without drag, m/s: c² M = K for grains and water together.
inline std::array<double, 2> wave_speeds(const BiotColumn& b) {
  const double n = b.porosity, f = 1 - n, q = b.bulk_modulus / n;
  const double ms = f * b.grain_density, mw = n * b.water_density;
  const double a = (b.modulus + q * f * f) / ms, c = q * n * n / mw, k = q * f * n;
  const double root = std::sqrt(0.25 * (a - c) * (a - c) + k * k / (ms * mw));
  return {std::sqrt(0.5 * (a + c) + root), std::sqrt(0.5 * (a + c) - root)};
}

/// Leap-frog with `cells` cells at half their stable step; the base is closed. z points down from the top.
inline BiotHistory solve(const BiotColumn& b, double depth, double duration, int cells) {
  const double n = b.porosity, f = 1 - n, dz = b.height / cells, dt = 0.5 * dz / wave_speeds(b)[0];
  const double ms = f * b.grain_density, mw = n * b.water_density, storage = b.bulk_modulus / n;
  std::vector<double> vs(cells + 1, 0), vw(cells + 1, 0), stress(cells, 0), p(cells, 0);
  const auto cell = static_cast<int>(depth / dz);
  BiotHistory h;
  for (double t = 0; t < duration; t += dt) {
    const double rise = b.load * std::min(1.0, (t + 0.5 * dt) / b.ramp);
    for (int i = 0; i < cells; ++i) {  // velocity i is above cell i; the last is the closed base
      const double length = i ? dz : 0.5 * dz;
      const double above_stress = i ? stress[i - 1] : -rise, above_p = i ? p[i - 1] : 0;
      const double gradient = (p[i] - above_p) / length;
      const double fs = ms * vs[i] + dt * ((stress[i] - above_stress) / length - f * gradient);
      const double fw = mw * vw[i] - dt * n * gradient, r = dt * b.drag;
      const double det = (ms + r) * (mw + r) - r * r;
      vs[i] = ((mw + r) * fs + r * fw) / det;
      vw[i] = ((ms + r) * fw + r * fs) / det;
    }
    for (int i = 0; i < cells; ++i) {
      stress[i] += dt * b.modulus * (vs[i + 1] - vs[i]) / dz;
      p[i] -= dt * storage * (f * (vs[i + 1] - vs[i]) + n * (vw[i + 1] - vw[i])) / dz;
    }
    h.time.push_back(t + dt);
    h.pressure.push_back(p[cell]);
    h.grains.push_back(0.5 * (vs[cell] + vs[cell + 1]));
    h.water.push_back(0.5 * (vw[cell] + vw[cell + 1]));
  }
  return h;
}

}  // namespace quicksand::test

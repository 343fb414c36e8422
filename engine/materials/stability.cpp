#include "engine/materials/stability.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/grid/kernel.hpp"

namespace quicksand {
namespace {

/// Largest |eigenvalue| of one step for waves of wave number κ (1/m). State: vs, vw, S, P with
/// σ′ = iS, p = iP, so that all coefficients are real:
///   (Ms + ΔtR) vs' − ΔtR vw' − Δt φκ P' = Ms vs − Δt κ S      S' = S + Δt Ec κ vs'
///   −ΔtR vs' + (Mw + ΔtR) vw' − Δt nκ P' = Mw vw              (n/KwΔt) (P' − P) = −κ (φ vs' + n vw')
double amplification(const SaturatedSoil& soil, double kappa, double dt) {
  const double n = soil.porosity, phi = 1 - n;
  const double ms = phi * soil.grain_density, mw = n * soil.water_density, r = dt * soil.drag;
  const double storage = n * soil.water_compliance / dt;
  Eigen::Matrix4d after = Eigen::Matrix4d::Zero(), before = Eigen::Matrix4d::Zero();
  after.row(0) << ms + r, -r, 0, -dt * phi * kappa;
  after.row(1) << -r, mw + r, 0, -dt * n * kappa;
  after.row(2) << -dt * soil.constrained_modulus * kappa, 0, 1, 0;
  after.row(3) << kappa * phi, kappa * n, 0, storage;
  before.row(0) << ms, 0, -dt * kappa, 0;
  before(1, 1) = mw;
  before(2, 2) = 1;
  before(3, 3) = storage;
  const Eigen::Matrix4d step = after.partialPivLu().solve(before);
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

double dry_step_limit(const SaturatedSoil& soil, double h) {
  return h / std::sqrt(soil.constrained_modulus / ((1 - soil.porosity) * soil.grain_density));
}

double coupled_step_limit(const SaturatedSoil& soil, double h) {
  // In units of the edge, the grains' mass and the dry limit, so that similar soils have the same bits.
  const double unit = dry_step_limit(soil, h), mass = (1 - soil.porosity) * soil.grain_density;
  SaturatedSoil plain = soil;
  plain.grain_density /= mass, plain.water_density /= mass;
  plain.constrained_modulus = 1;
  plain.water_compliance *= soil.constrained_modulus;
  plain.drag *= unit / mass;
  constexpr double kRounding = 1e-9;  // of an eigenvalue of modulus one
  const auto stable = [&](double dt) {
    for (double part : {1.0, 0.5, 0.25})  // of the shortest wave's 2/h
      if (amplification(plain, part * 2, dt) > 1 + kRounding) return false;
    return true;
  };
  double low = 0.1, high = low;
  if (!stable(low)) return low * unit;
  constexpr double kLargest = 1e6;  // of the dry limit; no soil is bound there
  while (stable(high) && high < kLargest * low) high *= 2;
  double bound = high / 2;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (bound + high);
    (stable(middle) ? bound : high) = middle;
  }
  return bound * unit;
}

double surface_step_limit(const SaturatedSoil& soil, double h) {
  const double mass = (1 - soil.porosity) * soil.grain_density;
  const double wave = soil.constrained_modulus / (mass * h * h), drag = soil.drag / mass;  // 1/s², 1/s
  return (drag + std::sqrt(drag * drag + 16 * wave)) / (4 * wave);
}

double shear_step_limit(const SaturatedSoil& soil, double h) {
  return h / std::sqrt(soil.shear_modulus / ((1 - soil.porosity) * soil.grain_density));
}

double fast_wave_step_limit(const SaturatedSoil& soil, double h) {
  // Larger root c² of det(K − c² M) = 0 with M = diag(Ms, Mw), Q = Kw/n and
  // K = [[Ec + Q (1−n)², Q n (1−n)], [Q n (1−n), Q n²]].
  const double n = soil.porosity, phi = 1 - n, q = 1 / (n * soil.water_compliance);
  const double ms = phi * soil.grain_density, mw = n * soil.water_density;
  const double a = (soil.constrained_modulus + q * phi * phi) / ms, b = q * n * n / mw;
  const double coupling = q * n * phi / std::sqrt(ms * mw);
  return h / std::sqrt(0.5 * (a + b) + std::hypot(0.5 * (a - b), coupling));
}

double bounding_edge(Kernel kernel, double h, int points_per_cell) {
  // One point feels so little of the strain between the faces that blocks in free flight gained energy from
  // rounding at 0.8 h/c; at 0.4 h/c they kept it over some 10⁴ steps (tests/extremes).
  constexpr double kLonePart = 0.5;
  const double part = points_per_cell == 1 ? kLonePart : 1;
  return part * (kernel == Kernel::linear ? 2 * std::sqrt(LinearHat::light_part) * h : h);
}

namespace {

/// Where stiffness varies, tables stand at that of soil without stress, than which none is softer, times 4^k.
constexpr int kStiffnesses =
    11;  // up to 10⁶ times; beyond, the bound falls as 1/modulus, no slower than it may

}  // namespace

StepLimit::StepLimit(const SoilMaterial& soil, double water_density, double water_compliance, double h,
                     double inertia) {
  // With densities × s, time √s times as long and velocities as small, all terms but the drag stay as they
  // are: the bounds are √s times those of the true densities with drag/√s.
  const double slower = std::sqrt(inertia);
  bounds_.resize(soil.varies_stiffness() ? kStiffnesses : 1);
  double modulus = softest_ = soil.constrained_modulus<2>({}, soil.porosity);
  for (Bounds& b : bounds_) {
    for (int i = 0; i < kEntries; ++i) {
      const double n = (i + 0.5) / kEntries;
      const SaturatedSoil s{modulus,
                            soil.grain_density,
                            water_density,
                            water_compliance,
                            n,
                            soil.drag.resistance(n) / slower,
                            soil.shear_share * modulus};
      b.dry[i] = slower * dry_step_limit(s, h);
      b.saturated[i] =
          slower * std::min({coupled_step_limit(s, h), surface_step_limit(s, h), shear_step_limit(s, h)});
      b.fast_wave[i] = water_compliance > 0 ? slower * fast_wave_step_limit(s, h)
                                            : std::numeric_limits<double>::infinity();
    }
    modulus *= 4;
  }
}

double StepLimit::least(Table Bounds::*table, const Range& n) const {
  if (n.low > n.high) return std::numeric_limits<double>::infinity();
  double smallest = std::min(look_up(table, n.low, softest_), look_up(table, n.high, softest_));
  const Table& t = bounds_.front().*table;
  for (int i = std::max(0, static_cast<int>(n.low * kEntries + 0.5)); i < kEntries; ++i) {
    if ((i + 0.5) / kEntries >= n.high) break;
    smallest = std::min(smallest, t[i]);
  }
  return smallest;
}

double StepLimit::look_up(Table Bounds::*table, double porosity, double modulus) const {
  const double at = std::clamp(porosity * kEntries - 0.5, 0.0, kEntries - 1.0001);
  const int i = static_cast<int>(at);
  const auto entry = [&](std::size_t k) {
    const Table& t = bounds_[k].*table;
    return t[i] + (at - i) * (t[i + 1] - t[i]);
  };
  if (bounds_.size() == 1) return entry(0);
  const double place = 0.5 * std::log2(std::max(modulus / softest_, 1.0));
  const std::size_t k = static_cast<std::size_t>(place), last = bounds_.size() - 1;
  if (k >= last) return entry(last) * std::pow(4, static_cast<double>(last) - place);
  const double part = place - static_cast<double>(k);  // bounds are powers of the modulus, nearly
  return std::isinf(entry(k)) ? entry(k) : entry(k) * std::pow(entry(k + 1) / entry(k), part);
}

}  // namespace quicksand

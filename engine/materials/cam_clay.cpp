#include "engine/materials/cam_clay.hpp"

#include "engine/scene/check_parts.hpp"

namespace quicksand {
namespace {

/// One step as the return sees it: scalars, because the deviator of the plastic strain is that of the stress.
struct Step {
  const CamClayLaw& law;
  double volume;      ///< –, 1 + e at the start of the step
  double p, pc;       ///< Pa, at the start
  double compressed;  ///< –, decrease of the void ratio in the step, exact for finite steps
  double ss, se, ee;  ///< s:s, s:e, e:e of the stress at the start and the deviator of the strain

  double pressure(double elastic) const { return p * std::exp(elastic / law.swelling); }
  /// Secant of the elastic law over the step, so that p and G see the same stiffness; Pa.
  double shear(double elastic) const {
    const double x = elastic / law.swelling;
    const double secant = std::abs(x) < 1e-8 ? 1 + 0.5 * x : std::expm1(x) / x;
    return law.shear_ratio * volume * p / law.swelling * secant;
  }
  double q2(double g) const { return std::max(0.0, 1.5 * (ss + 4 * g * se + 4 * g * g * ee)); }
};

/// State for a plastic multiplier.
struct Trial {
  double p, pc, shear, factor, f;  ///< factor: of the trial's deviator
};

/// y = 2p − pc for a given multiplier: the root of a function that falls everywhere, bracketed by 0 and its
/// value at 0; safeguarded Newton.
double flow_direction(const Step& s, double phi) {
  const double a = s.volume * phi / s.law.swelling, b = s.volume * phi / (s.law.compression - s.law.swelling);
  const double p0 = 2 * s.pressure(s.compressed), start = p0 - s.pc;
  double low = std::min(0.0, start), high = std::max(0.0, start), y = 0;
  constexpr int kMost = 60;  // halvings reach rounding
  for (int i = 0; i < kMost; ++i) {
    const double water = p0 * std::exp(-a * y), hard = s.pc * std::exp(b * y);
    const double h = water - hard - y;
    (h > 0 ? low : high) = y;
    double next = y + h / (a * water + b * hard + 1);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - y) <= 1e-15 * (p0 + s.pc)) return next;
    y = next;
  }
  return y;
}

Trial with_multiplier(const Step& s, double phi) {
  Trial t;
  const double m2 = s.law.slope * s.law.slope;
  const double plastic = s.volume * phi * flow_direction(s, phi);  // decrease of void ratio
  t.p = s.pressure(s.compressed - plastic);
  t.pc = s.pc * std::exp(plastic / (s.law.compression - s.law.swelling));
  t.shear = s.shear(s.compressed - plastic);
  t.factor = 1 / (1 + 6 * t.shear * phi / m2);
  t.f = t.factor * t.factor * s.q2(t.shear) / m2 + t.p * (t.p - t.pc);
  return t;
}

/// Multiplier (1/Pa) with f = 0: bracketed, f > 0 without and f < 0 with much plastic strain, then by regula
/// falsi with Illinois' weights.
double multiplier(const Step& s, const Trial& elastic) {
  const double m2 = s.law.slope * s.law.slope, y = 2 * elastic.p - elastic.pc;
  const double slope =
      12 * elastic.shear * s.q2(elastic.shear) / (m2 * m2) + y * y * elastic.p * s.volume / s.law.swelling;
  double low = 0, f_low = elastic.f, high = elastic.f / slope, f_high = with_multiplier(s, high).f;
  constexpr int kDoublings = 200;
  for (int i = 0; i < kDoublings && f_high > 0; ++i) {
    low = high, f_low = f_high;
    high *= 2;
    f_high = with_multiplier(s, high).f;
  }
  constexpr double kRounding = 1e-13;  // of the terms of f
  constexpr int kMost = 300;           // some 10 are needed where strains are small
  int side = 0;
  for (int i = 0; i < kMost && high - low > 1e-15 * high; ++i) {
    // Every fourth time a halving, for steps so large that f is far from straight.
    const double phi = i % 4 == 3 ? 0.5 * (low + high) : (low * f_high - high * f_low) / (f_high - f_low);
    const Trial t = with_multiplier(s, phi);
    const double f = t.f;
    if (std::abs(f) <= kRounding * t.p * (t.p + t.pc)) return phi;
    if (f > 0) {
      low = phi, f_low = f;
      if (side == 1) f_high *= 0.5;
      side = 1;
    } else {
      high = phi, f_high = f;
      if (side == -1) f_low *= 0.5;
      side = -1;
    }
  }
  return high;
}

}  // namespace

CamClayLaw CamClayLaw::from(const SoilModel& m) {
  CamClayLaw law;
  law.compression = m.compression_slope;
  law.swelling = m.swelling_slope;
  law.slope = m.critical_state_slope;
  law.shear_ratio = 3 * (1 - 2 * m.poisson_ratio) / (2 * (1 + m.poisson_ratio));
  law.over_consolidation = m.over_consolidation_ratio;
  return law;
}

void CamClayLaw::check(const SoilModel& m, ModelFaults& faults) {
  if (m.swelling_slope >= m.compression_slope)
    faults.push_back({"swelling_slope", text(m.swelling_slope) + " is not below the compression_slope " +
                                            text(m.compression_slope) +
                                            ": the clay would not harden; give a smaller one"});
}

template <int D>
int CamClayLaw::begin(SoilState<D>& state) const {
  int held = 0;
  double p = -trace(state.stress) / 3;
  if (p < least_pressure) {
    p = least_pressure;
    state.stress = {};
    for (int i = 0; i < 3; ++i) state.stress[i] = -p;
    held = 1;
  }
  const double q2 = 1.5 * contracted(deviator(state.stress));
  state.preconsolidation = over_consolidation * (p + q2 / (slope * slope * p));
  return held;
}

template <int D>
int CamClayLaw::update(SoilState<D>& state, const Strain<D>& strain, double porosity) const {
  int held = 0;
  Stress<D> s = deviator(state.stress);
  const Strain<D> e = deviator(strain);
  double p = -trace(state.stress) / 3;
  if (p < least_pressure) {  // grains that did not touch
    p = least_pressure, s = {};
    held = 1;
  }
  double se = 0;
  for (std::size_t i = 0; i < s.size(); ++i) se += (i < 3 ? 1 : 2) * s[i] * e[i];
  const double volume = 1 / (1 - porosity);
  const Step step{*this,
                  volume,
                  p,
                  std::max(state.preconsolidation, least_pressure),
                  -volume * trace(strain),
                  contracted(s),
                  se,
                  contracted(e)};
  Trial t = with_multiplier(step, 0);
  // Rounding of the yield function, as a part of its terms.
  constexpr double kRounding = 1e-12;
  if (t.f > kRounding * t.p * t.pc) {
    const double phi = multiplier(step, t);
    t = with_multiplier(step, phi);
    const double q = t.factor * std::sqrt(step.q2(t.shear));
    state.plastic_strain += 2 * phi * q / (slope * slope);
  }
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = t.factor * (s[i] + 2 * t.shear * e[i]);
  if (t.p < least_pressure || t.pc < least_pressure) {
    t.p = std::max(t.p, least_pressure);
    t.pc = std::max(t.pc, t.p);
    const double q = std::sqrt(1.5 * contracted(s)), most = slope * std::sqrt(t.p * (t.pc - t.p));
    for (double& c : s) c *= q > most ? most / q : 1;
    held = 1;
  }
  state.stress = s;
  for (int i = 0; i < 3; ++i) state.stress[i] -= t.p;
  state.preconsolidation = t.pc;
  return held;
}

template int CamClayLaw::begin<2>(SoilState<2>&) const;
template int CamClayLaw::begin<3>(SoilState<3>&) const;
template int CamClayLaw::update<2>(SoilState<2>&, const Strain<2>&, double) const;
template int CamClayLaw::update<3>(SoilState<3>&, const Strain<3>&, double) const;

}  // namespace quicksand

#include "engine/materials/mohr_coulomb.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene/check_parts.hpp"

namespace quicksand {
namespace {

/// One face of the pyramid: σ_i is the larger and σ_j the smaller principal stress on it.
struct Face {
  int i, j;
};

double excess(const MohrCoulomb& law, const std::array<double, 3>& s, Face f) {
  return (s[f.i] - s[f.j]) + (s[f.i] + s[f.j]) * law.sin_phi - 2 * law.cohesion * law.cos_phi;
}

/// Gradient of the plastic potential, the flow direction in principal strains.
std::array<double, 3> flow(const MohrCoulomb& law, Face f) {
  std::array<double, 3> n{};
  n[f.i] = 1 + law.sin_psi;
  n[f.j] = -1 + law.sin_psi;
  return n;
}

std::array<double, 3> stress_of(const Elastic& e, const std::array<double, 3>& strain) {
  const double volume = e.lame() * (strain[0] + strain[1] + strain[2]);
  return {volume + 2 * e.shear * strain[0], volume + 2 * e.shear * strain[1],
          volume + 2 * e.shear * strain[2]};
}

/// d(yield of f)/d(multiplier of g), sign changed: the elastic stiffness between two faces.
double stiffness(const MohrCoulomb& law, const Elastic& e, Face f, Face g) {
  const auto s = stress_of(e, flow(law, g));
  return (s[f.i] - s[f.j]) + (s[f.i] + s[f.j]) * law.sin_phi;
}

MohrCoulombReturn relax(const MohrCoulomb& law, const Elastic& e, const std::array<double, 3>& trial, Face f,
                        double gamma_f, Face g, double gamma_g, YieldRegion region) {
  MohrCoulombReturn r{trial, {}, region};
  const auto nf = flow(law, f), ng = flow(law, g);
  for (int a = 0; a < 3; ++a) r.plastic_strain[a] = gamma_f * nf[a] + gamma_g * ng[a];
  const auto drop = stress_of(e, r.plastic_strain);
  for (int a = 0; a < 3; ++a) r.stress[a] -= drop[a];
  return r;
}

bool sorted(const std::array<double, 3>& s, double tolerance) {
  return s[0] >= s[1] - tolerance && s[1] >= s[2] - tolerance;
}

MohrCoulombReturn return_to_edge(const MohrCoulomb& law, const Elastic& e, const std::array<double, 3>& trial,
                                 Face second, YieldRegion region) {
  const Face first{0, 2};
  const double f1 = excess(law, trial, first), f2 = excess(law, trial, second);
  const double a11 = stiffness(law, e, first, first), a12 = stiffness(law, e, first, second);
  const double a21 = stiffness(law, e, second, first), a22 = stiffness(law, e, second, second);
  const double det = a11 * a22 - a12 * a21;
  return relax(law, e, trial, first, (a22 * f1 - a12 * f2) / det, second, (a11 * f2 - a21 * f1) / det,
               region);
}

MohrCoulombReturn return_to_apex(const MohrCoulomb& law, const Elastic& e,
                                 const std::array<double, 3>& trial) {
  const double apex = law.apex();
  MohrCoulombReturn r{{apex, apex, apex}, {}, YieldRegion::apex};
  const double mean = (trial[0] + trial[1] + trial[2]) / 3;
  for (int a = 0; a < 3; ++a)
    r.plastic_strain[a] = (trial[a] - mean) / (2 * e.shear) + (mean - apex) / (3 * e.bulk);
  return r;
}

MohrCoulombReturn return_to_pyramid(const MohrCoulomb& law, const Elastic& e,
                                    const std::array<double, 3>& trial, double f, double scale) {
  const Face main{0, 2};
  const double tolerance = 1e-12 * scale;
  MohrCoulombReturn r =
      relax(law, e, trial, main, f / stiffness(law, e, main, main), main, 0, YieldRegion::face);
  if (!sorted(r.stress, tolerance)) {
    // Leaving the sector across σ1 = σ2 or σ2 = σ3 names the second active face.
    if (r.stress[1] > r.stress[0])
      r = return_to_edge(law, e, trial, Face{1, 2}, YieldRegion::edge_compression);
    else
      r = return_to_edge(law, e, trial, Face{0, 1}, YieldRegion::edge_extension);
  }
  if (law.sin_phi > 0 && (!sorted(r.stress, tolerance) || r.stress[2] > law.apex() + tolerance))
    return return_to_apex(law, e, trial);
  return r;
}

}  // namespace

MohrCoulombReturn return_map(const MohrCoulomb& law, const Elastic& e, const std::array<double, 3>& trial) {
  const double scale = std::abs(trial[0]) + std::abs(trial[2]) + law.cohesion;
  const double f = excess(law, trial, Face{0, 2});
  const MohrCoulombReturn r = f <= 1e-14 * scale ? MohrCoulombReturn{trial, {}, YieldRegion::elastic}
                                                 : return_to_pyramid(law, e, trial, f, scale);
  // Where shear alone leaves no stress above the cut-off, its planes take no part.
  if (law.tension >= law.apex() || r.stress[0] <= law.tension) return r;
  return return_to_cutoff(law, e, trial);
}

FaceReturn FaceReturn::of(const MohrCoulomb& law, const Elastic& e) {
  const Face main{0, 2};
  const auto direction = flow(law, main);
  const double own = stiffness(law, e, main, main);
  const auto edge = [&](Face second) {
    const auto along = flow(law, second);
    // Both stiffnesses between the faces are one: they share an axis, and all faces change volume alike.
    const double between = stiffness(law, e, main, second), det = own * own - between * between;
    const auto [a, b, c] = deviator(direction);
    const auto [x, y, z] = deviator(along);
    return EdgeReturn{stress_of(e, along), own / det, between / det, 2.0 / 3.0 * (a * x + b * y + c * z)};
  };
  return {stress_of(e, direction), 1 / own, std::sqrt(2.0 / 3.0 * contracted(deviator(direction))),
          edge({1, 2}), edge({0, 1})};
}

MohrCoulombLaw MohrCoulombLaw::from(const SoilModel& m) {
  constexpr double kRadians = std::numbers::pi / 180;
  MohrCoulombLaw law;
  law.elastic = Elastic::from_young(m.young_modulus, m.poisson_ratio);
  law.peak.sin_phi = std::sin(m.friction_angle * kRadians);
  law.peak.cos_phi = std::cos(m.friction_angle * kRadians);
  law.peak.sin_psi = std::sin(m.dilation_angle * kRadians);
  law.peak.cohesion = m.cohesion;
  if (m.tension_cutoff) law.peak.tension = *m.tension_cutoff;
  if (m.residual_cohesion) {
    law.residual_cohesion = *m.residual_cohesion;
    law.softening_strain = m.softening_strain;
  }
  law.face = FaceReturn::of(law.peak, law.elastic);
  return law;
}

void MohrCoulombLaw::check(const SoilModel& m, ModelFaults& faults) {
  if (m.dilation_angle > m.friction_angle)
    faults.push_back({"dilation_angle",
                      text(m.dilation_angle) + "° is above the friction angle " + text(m.friction_angle) +
                          "°: the soil would create energy; give at most the friction angle"});
  if (m.friction_angle == 0 && m.cohesion == 0)
    faults.push_back(
        {"friction_angle", "no friction and no cohesion: soil without strength; give one of them"});
  const double apex = from(m).peak.apex();
  if (m.tension_cutoff && *m.tension_cutoff > apex)
    faults.push_back({"tension_cutoff", text(*m.tension_cutoff) +
                                            " Pa has no effect: friction and cohesion " +
                                            "allow at most cohesion / tan(friction_angle) = " + text(apex) +
                                            " Pa; give less or remove it"});
  if (m.residual_cohesion && *m.residual_cohesion >= m.cohesion)
    faults.push_back({"residual_cohesion", text(*m.residual_cohesion) + " Pa is not below the cohesion " +
                                               text(m.cohesion) + " Pa: nothing would soften; remove it"});
  if (m.residual_cohesion && !(m.softening_strain > 0))
    faults.push_back({"softening_strain",
                      "is needed with residual_cohesion: the plastic shear strain at which it is reached"});
  if (!m.residual_cohesion && m.softening_strain > 0)
    faults.push_back({"softening_strain", "has no effect without residual_cohesion: remove it"});
}

template <int D>
void MohrCoulombLaw::yield(double cohesion, SoilState<D>& state) const {
  MohrCoulomb now = peak;
  now.cohesion = cohesion;
  const Principal<D> trial = principal(state.stress);
  const MohrCoulombReturn r = return_map(now, elastic, trial.value);
  if (r.region == YieldRegion::elastic) return;
  state.stress = with_values(trial, r.stress);
  state.plastic_strain += plastic_shear(r);
}

template void MohrCoulombLaw::yield<2>(double, SoilState<2>&) const;
template void MohrCoulombLaw::yield<3>(double, SoilState<3>&) const;

}  // namespace quicksand

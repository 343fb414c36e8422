#include "engine/materials/mohr_coulomb.hpp"

#include <algorithm>
#include <cmath>

namespace quicksand {
namespace {

/// One face of the pyramid: σ_i is the larger and σ_j the smaller principal stress on it.
struct Face {
  int i, j;
};

double yield(const MohrCoulomb& law, const std::array<double, 3>& s, Face f) {
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
  const double f1 = yield(law, trial, first), f2 = yield(law, trial, second);
  const double a11 = stiffness(law, e, first, first), a12 = stiffness(law, e, first, second);
  const double a21 = stiffness(law, e, second, first), a22 = stiffness(law, e, second, second);
  const double det = a11 * a22 - a12 * a21;
  return relax(law, e, trial, first, (a22 * f1 - a12 * f2) / det, second, (a11 * f2 - a21 * f1) / det,
               region);
}

MohrCoulombReturn return_to_apex(const MohrCoulomb& law, const Elastic& e,
                                 const std::array<double, 3>& trial) {
  const double apex = law.cohesion * law.cos_phi / law.sin_phi;
  MohrCoulombReturn r{{apex, apex, apex}, {}, YieldRegion::apex};
  const double mean = (trial[0] + trial[1] + trial[2]) / 3;
  for (int a = 0; a < 3; ++a)
    r.plastic_strain[a] = (trial[a] - mean) / (2 * e.shear) + (mean - apex) / (3 * e.bulk);
  return r;
}

}  // namespace

MohrCoulombReturn return_map(const MohrCoulomb& law, const Elastic& e, const std::array<double, 3>& trial) {
  const Face main{0, 2};
  const double scale = std::abs(trial[0]) + std::abs(trial[2]) + law.cohesion;
  const double f = yield(law, trial, main);
  if (f <= 1e-14 * scale) return {trial, {}, YieldRegion::elastic};

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
  if (law.sin_phi > 0) {
    const double apex = law.cohesion * law.cos_phi / law.sin_phi;
    if (!sorted(r.stress, tolerance) || r.stress[2] > apex + tolerance) return return_to_apex(law, e, trial);
  }
  return r;
}

}  // namespace quicksand

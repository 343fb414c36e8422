// Mohr–Coulomb cut by planes of largest tension: σ1, σ2, σ3 ≤ T below the apex.
//
// All surfaces are planes in principal stress space and the elastic stiffness C is constant, so the return is
// a linear complementarity problem: stress = trial − C Σ γ_k n_k with γ_k ≥ 0, every f_k ≤ 0, γ_k f_k = 0.
// The sets of planes that can be active together are few; the first whose multipliers and stress are
// admissible is the solution, exact at edges and corners.

#include <Eigen/Dense>
#include <algorithm>

#include "engine/materials/mohr_coulomb.hpp"

namespace quicksand {
namespace {

using Eigen::Vector3d;

/// f = normal·σ − offset ≤ 0; plastic strain along `flow`.
struct Plane {
  Vector3d normal, flow;
  double offset = 0;
};

enum PlaneName { shear_13, shear_12, shear_23, tension_1, tension_2, tension_3, kPlanes };
using Planes = std::array<Plane, kPlanes>;

Planes planes_of(const MohrCoulomb& law) {
  Planes planes;
  constexpr int pairs[3][2] = {{0, 2}, {0, 1}, {1, 2}};
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = pairs[k];
    Plane& p = planes[k];
    p.normal = p.flow = Vector3d::Zero();
    p.normal[i] = 1 + law.sin_phi, p.normal[j] = -1 + law.sin_phi;
    p.flow[i] = 1 + law.sin_psi, p.flow[j] = -1 + law.sin_psi;
    p.offset = 2 * law.cohesion * law.cos_phi;
    planes[3 + k] = {Vector3d::Unit(k), Vector3d::Unit(k), law.tension};
  }
  return planes;
}

struct ActiveSet {
  int count;
  std::array<PlaneName, 3> plane;
};
/// Faces, edges and corners of the cut pyramid. Four planes meet where σ1 = σ2 = T: two shear planes or two
/// tension planes with one of the others span every multiplier there.
constexpr ActiveSet kSets[] = {
    {1, {tension_1}},
    {2, {tension_1, shear_13}},
    {2, {tension_1, tension_2}},
    {3, {tension_1, shear_13, shear_12}},
    {3, {tension_1, tension_2, shear_13}},
    {3, {tension_1, tension_2, shear_23}},
    {3, {tension_1, shear_13, shear_23}},
    {3, {tension_2, shear_13, shear_23}},
    {3, {tension_1, tension_2, tension_3}},
};

/// Multipliers of the active planes; not finite where the planes do not meet in one place.
Vector3d multipliers(const Planes& planes, const ActiveSet& set, const Eigen::Matrix3d& stiffness,
                     const Vector3d& trial) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Identity();
  Vector3d f = Vector3d::Zero();
  for (int k = 0; k < set.count; ++k) {
    const Plane& p = planes[set.plane[k]];
    f[k] = p.normal.dot(trial) - p.offset;
    for (int m = 0; m < set.count; ++m) a(k, m) = p.normal.dot(stiffness * planes[set.plane[m]].flow);
  }
  return a.inverse() * f;
}

}  // namespace

MohrCoulombReturn return_to_cutoff(const MohrCoulomb& law, const Elastic& elastic,
                                   const std::array<double, 3>& trial) {
  const Planes planes = planes_of(law);
  const Eigen::Matrix3d stiffness =
      Eigen::Matrix3d::Constant(elastic.lame()) + 2 * elastic.shear * Eigen::Matrix3d::Identity();
  const Vector3d start(trial[0], trial[1], trial[2]);
  const double scale = start.cwiseAbs().maxCoeff() + law.cohesion + law.tension;
  constexpr double kRounding = 1e-11;  // of the stresses involved

  MohrCoulombReturn best{};
  double least = std::numeric_limits<double>::infinity();
  for (const ActiveSet& set : kSets) {
    const Vector3d gamma = multipliers(planes, set, stiffness, start);
    if (!gamma.allFinite()) continue;
    Vector3d strain = Vector3d::Zero();
    for (int k = 0; k < set.count; ++k) strain += gamma[k] * planes[set.plane[k]].flow;
    const Vector3d stress = start - stiffness * strain;
    double violation = std::max({0.0, stress[1] - stress[0], stress[2] - stress[1]});
    for (int k = 0; k < set.count; ++k) violation = std::max(violation, -gamma[k] * elastic.shear);
    for (const Plane& p : planes) violation = std::max(violation, p.normal.dot(stress) - p.offset);
    if (violation >= least) continue;
    least = violation;
    for (int a = 0; a < 3; ++a) best.stress[a] = stress[a], best.plastic_strain[a] = strain[a];
    if (violation <= kRounding * scale) break;
  }
  best.region = YieldRegion::tension;
  return best;
}

}  // namespace quicksand

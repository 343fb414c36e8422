#pragma once
// Constitutive equations integrated independently of the engine: rate equations with the continuum tangent,
// gradients of yield and potential by differences, second-order Runge–Kutta in tiny steps. Components are
// xx yy zz xy, tension positive; y is the axis of triaxial tests, x and z are lateral.

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "engine/scene/scene.hpp"

namespace quicksand::test {

using Four = Eigen::Vector4d;

inline double mean_pressure(const Four& s) { return -(s[0] + s[1] + s[2]) / 3; }
inline double von_mises(const Four& s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * s[3] * s[3]);
}
inline std::array<double, 3> sorted_principal(const Four& s) {
  Eigen::Matrix3d m;
  m << s[0], s[3], 0, s[3], s[1], 0, 0, 0, s[2];
  const Eigen::Vector3d e =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues();
  return {e[2], e[1], e[0]};
}

/// One material point that follows the rate equations.
struct ReferencePoint {
  SoilModel model;
  Four stress = Four::Zero();
  double void_ratio = 1, hardening = 0;  ///< hardening: pc of Cam-Clay (Pa), plastic shear strain else

  bool cam_clay() const { return model.law == SoilLaw::modified_cam_clay; }

  double bulk(const Four& s, double e) const {
    return cam_clay() ? (1 + e) * mean_pressure(s) / model.swelling_slope
                      : model.young_modulus / (3 * (1 - 2 * model.poisson_ratio));
  }
  Four elastic(const Four& s, double e, const Four& strain) const {
    const double k = bulk(s, e), g = 1.5 * k * (1 - 2 * model.poisson_ratio) / (1 + model.poisson_ratio);
    const double volume = strain[0] + strain[1] + strain[2];
    Four r = 2 * g * strain;
    for (int i = 0; i < 3; ++i) r[i] += (k - 2 * g / 3) * volume;
    return r;
  }
  double yield(const Four& s, double h) const {
    if (model.law == SoilLaw::linear_elastic) return -1;
    if (cam_clay()) {
      const double p = mean_pressure(s), q = von_mises(s), m = model.critical_state_slope;
      return std::sqrt(q * q / (m * m) + p * p) - std::sqrt(p * h);  // a root, so that it scales as a stress
    }
    const double phi = model.friction_angle * M_PI / 180;
    double c = model.cohesion;
    if (model.residual_cohesion) {
      const double part = std::min(h / model.softening_strain, 1.0);
      c += part * (*model.residual_cohesion - c);
    }
    const auto v = sorted_principal(s);
    const double shear = 0.5 * (v[0] - v[2]) + 0.5 * (v[0] + v[2]) * std::sin(phi) - c * std::cos(phi);
    return model.tension_cutoff ? std::max(shear, v[0] - *model.tension_cutoff) : shear;
  }
  double potential(const Four& s, double h) const {
    if (cam_clay()) return yield(s, h);
    const double psi = model.dilation_angle * M_PI / 180;
    const auto v = sorted_principal(s);
    if (model.tension_cutoff && yield(s, h) == v[0] - *model.tension_cutoff) return v[0];
    return 0.5 * (v[0] - v[2]) + 0.5 * (v[0] + v[2]) * std::sin(psi);
  }
  /// Derivatives by components, by central differences; a corner that the path keeps by symmetry gets the
  /// mean of its faces.
  template <class F>
  Four gradient(const F& f, const Four& s) const {
    const double h = 1e-5 * (std::abs(mean_pressure(s)) + von_mises(s) + 1);
    Four d;
    for (int i = 0; i < 4; ++i) {
      Four up = s, down = s;
      up[i] += h, down[i] -= h;
      d[i] = (f(up) - f(down)) / (2 * h);
    }
    return d;
  }

  struct Rate {
    Four stress;
    double hardening = 0;
  };
  /// Change for a small strain; `plastic`: on the yield surface.
  Rate rate(const Four& s, double h, double e, const Four& strain, bool plastic) const {
    Rate r{elastic(s, e, strain), 0};
    if (!plastic) return r;
    const Four a = gradient([&](const Four& x) { return yield(x, h); }, s);
    Four flow = gradient([&](const Four& x) { return potential(x, h); }, s);
    flow[3] *= 0.5;  // of the tensor: the component stands for two
    const double volume = flow[0] + flow[1] + flow[2];
    double growth;  // of the hardening variable per multiplier
    if (cam_clay()) {
      growth = -h * (1 + e) * volume / (model.compression_slope - model.swelling_slope);
    } else {
      const Four d = flow - Four(1, 1, 1, 0) * volume / 3;
      growth = std::sqrt(2.0 / 3.0 * (d.head<3>().squaredNorm() + 2 * d[3] * d[3]));
    }
    const double step = 1e-6 * (std::abs(h) + 1e-3);
    const double slope = (yield(s, h + step) - yield(s, h - step)) / (2 * step);
    const Four drop = elastic(s, e, flow);
    const double multiplier = a.dot(r.stress) / (a.dot(drop) - slope * growth);
    if (multiplier <= 0) return r;  // unloading
    r.stress -= multiplier * drop;
    r.hardening = multiplier * growth;
    return r;
  }

  /// A small strain and a small spin (half the difference of the displacement gradients xy and yx).
  void strain(const Four& de, double spin = 0) {
    const bool on_surface = yield(stress, hardening) > -1e-9 * (1 + von_mises(stress));
    Rate first = rate(stress, hardening, void_ratio, de, on_surface);
    if (!on_surface && yield(stress + first.stress, hardening) > 0) {
      double low = 0, high = 1;  // part of the strain up to the surface
      for (int i = 0; i < 50; ++i) {
        const double part = 0.5 * (low + high);
        (yield(stress + part * first.stress, hardening) > 0 ? high : low) = part;
      }
      advance(low * de, low * spin, {low * first.stress, 0});
      const Four rest = (1 - low) * de;
      return advance(rest, (1 - low) * spin, rate(stress, hardening, void_ratio, rest, true));
    }
    const double e_half = void_ratio + 0.5 * (1 + void_ratio) * (de[0] + de[1] + de[2]);
    const Rate middle =
        rate(stress + 0.5 * first.stress, hardening + 0.5 * first.hardening, e_half, de, on_surface);
    advance(de, spin, middle);
  }

 private:
  void advance(const Four& de, double spin, const Rate& r) {
    const Four s = stress + 0.5 * r.stress;
    stress += r.stress;  // and the Jaumann rate's rotation, w_xy = spin
    stress += Four(2 * spin * s[3], -2 * spin * s[3], 0, spin * (s[1] - s[0]));
    hardening += r.hardening;
    void_ratio += (1 + void_ratio) * (de[0] + de[1] + de[2]);
  }
};

}  // namespace quicksand::test

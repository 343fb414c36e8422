// Surface loads on soil.
//
// A traction t on a surface S enters the weak form as ∫_S t w dS. Taken at markers on S it does not balance
// the stress of the few points below, whose kernels the surface cuts: the row under the load is then stressed
// by tens of per cent more or less, as the points lie in their cells. So the surface integral is turned into
// one over the layer below it. With χ = 1 on S and 0 from `kLoadDepth` down, and N the outward direction at
// the start,
//   ∫_S t w dS = ∫_V0 t ∂(χ w)/∂N dV0 = ∫_V0 t [χ (F N)·∇w + w ∂χ/∂N] dV0,
// summed over markers that move with the points of that layer. Stress and load are then summed alike, and
// what is left of their difference, (1−χ) σ, vanishes where the surface cuts the kernels. χ is constant over
// the share of each point and jumps between them, where the second term has its markers: with points on their
// lattice the sum is exact.

#include <cmath>

#include "engine/step/move_point.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

template <int D>
double dot(const Vec<D>& a, const Vec<D>& b) {
  double sum = 0;
  for (int d = 0; d < D; ++d) sum += a[d] * b[d];
  return sum;
}

/// Velocity (m/s) and its gradient (1/s) of the grains at x.
template <class Shape, int D>
Vec<D> grains_at(const State<D>& s, const PointKernel<D, Shape>& kernel, Gradient<D>& l) {
  Vec<D> v{};
  for (int d = 0; d < D; ++d)
    for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, double w, double sign, const Vec<D>& gradient) {
      const double soil = sign * s.speeds[d][face].soil;
      v[d] += w * soil;
      for (int j = 0; j < D; ++j) l[d][j] += gradient[j] * soil;
    });
  return v;
}

}  // namespace

/// Few: serial, in the order of their markers.
template <int D>
void loads_to_faces(State<D>& s) {
  s.load_force = {};
  with_kernel(s.constants.kernel, [&](auto shape) {
    for (const SurfaceLoad<D>& load : s.loads) {
      if (!load.active) continue;
      const double rise = load.ramp > 0 ? std::min(1.0, (s.time - load.start) / load.ramp) : 1.0;
      for (const LoadMarker<D>& m : load.markers) {
        const PointKernel<D, decltype(shape)> kernel(s.grid, m.x);
        for (int d = 0; d < D; ++d) {
          const double t = rise * load.traction[d];
          s.load_force[d] += m.area * t;
          for_faces(
              s.grid, s.soil_walls, kernel, d, [&](int face, double w, double sign, const Vec<D>& gradient) {
                s.sums[d].add_force(face, sign * t * (m.volume * dot<D>(m.normal, gradient) + m.area * w));
              });
        }
      }
    }
  });
}

template <int D>
void move_loads(State<D>& s, double dt) {
  with_kernel(s.constants.kernel, [&](auto shape) {
    for (SurfaceLoad<D>& load : s.loads)
      for (LoadMarker<D>& m : load.markers) {
        const PointKernel<D, decltype(shape)> kernel(s.grid, m.x);
        Gradient<D> l{};
        Vec<D> step = grains_at<decltype(shape), D>(s, kernel, l);
        for (double& component : step) component *= dt;
        const Vec<D> before = m.normal;
        for (int d = 0; d < D; ++d) m.normal[d] += dt * dot<D>(l[d], before);
        move_point<D>(s.grid, s.soil_walls, kernel.home(), m.x, step);
      }
  });
}

template void loads_to_faces<2>(State<2>&);
template void loads_to_faces<3>(State<3>&);
template void move_loads<2>(State<2>&, double);
template void move_loads<3>(State<3>&, double);

}  // namespace quicksand

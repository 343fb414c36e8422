// Viscous stress of the water, explicitly, on the faces: ∇·(nτ)/(nρw) ≈ µ/ρw ∇²vw  [FMS19] eq. (2).

#include <algorithm>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

template <int D>
double old_velocity(const State<D>& s, int d, int face) {
  const MassSum& f = s.sums[d].water[face];
  return f.momentum / f.mass;
}

/// Difference of velocity to the neighbour of `face` along `axis`, m/s, times the part of the face's water
/// that the neighbour has, too: what one gains the other loses, also beside a surface where faces hold
/// little. A free surface and a slip wall pass no shear; at a no-slip wall the velocity is mirrored with its
/// sign changed.
template <int D>
double difference(const State<D>& s, int d, int face, int axis, int side) {
  const int offset = (2 * side - 1) * s.grid.stride[axis], other = face + offset;
  const double v = old_velocity(s, d, face);
  if (axis == d) {
    if (s.water_walls.closed(d, other)) return -v;
  } else {
    for (int cell : {face, face - s.grid.stride[d]}) {
      const int wall = cell + side * s.grid.stride[axis];
      if (s.water_walls.closed(axis, wall)) return s.water_walls.no_slip(axis, wall) ? -2 * v : 0;
    }
  }
  const double there = s.sums[d].water[other].mass / s.volume.face(d, other);
  if (there <= kMassCutoff * s.constants.water_density) return 0;
  const double here = s.sums[d].water[face].mass / s.volume.face(d, face);
  return std::min(1.0, there / here) * (old_velocity(s, d, other) - v);
}

}  // namespace

namespace {

/// h² ∇²v about an axis: (1/r) ∂(r ∂v/∂r)/∂r + ∂²v/∂z², less v/r² of the radial component.
double axial_laplacian(const State<2>& s, int d, int face) {
  const Grid<2>& grid = s.grid;
  const double r = grid.face_radius(d, face);
  double sum = difference(s, d, face, 1, 0) + difference(s, d, face, 1, 1);
  for (int side : {0, 1}) {
    // Between faces of the radial component lie cell centres, between those of the other its faces.
    const double between =
        d == 0 ? grid.cell_radius(side ? face : face - 1) : grid.face_radius(0, face + side);
    sum += between / r * difference(s, d, face, 0, side);
  }
  return d == 0 ? sum - old_velocity(s, d, face) * grid.h * grid.h / (r * r) : sum;
}

}  // namespace

template <int D>
double viscous_acceleration(const State<D>& s, int d, int face) {
  const double per_velocity =
      s.constants.viscosity / s.constants.water_density * s.grid.inverse_h * s.grid.inverse_h;
  if constexpr (D == 2) {
    if (s.grid.axial) return per_velocity * axial_laplacian(s, d, face);
  }
  double sum = 0;
  for (int axis = 0; axis < D; ++axis)
    for (int side : {0, 1}) sum += difference(s, d, face, axis, side);
  return per_velocity * sum;
}

template double viscous_acceleration<2>(const State<2>&, int, int);
template double viscous_acceleration<3>(const State<3>&, int, int);

}  // namespace quicksand

// Points → faces and cells: masses, momenta, internal forces, drag, volumes.

#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

/// Row d of the symmetric effective stress.
template <int D>
Vec<D> stress_row(const Stress<D>& s, int d) {
  if constexpr (D == 2)
    return d == 0 ? Vec<2>{s[0], s[3]} : Vec<2>{s[3], s[1]};
  else
    return d == 0 ? Vec<3>{s[0], s[3], s[5]} : d == 1 ? Vec<3>{s[3], s[1], s[4]} : Vec<3>{s[5], s[4], s[2]};
}

/// m/s, for drag that follows it.
template <int D>
double discharge_of(const SoilPoints<D>& soil, std::size_t p) {
  return soil.discharge.empty() ? 0 : soil.discharge[p];
}

/// Velocity of component d that a point gives to a face: its own, and with the affine transfer what its
/// gradient adds on the way there. [JSSTS15] eq. (8), per component of the staggered grid.
template <class S, int D>
double velocity_at_face(const PointSet<D>& set, std::uint32_t p, int d, const FaceWeight<D>& weight) {
  double v = set.v[p][d];
  if constexpr (S::affine)
    for (int j = 0; j < D; ++j) v += set.affine[p][d][j] * weight.arm[j];
  return v;
}

template <class S, int D>
void soil_to_faces(State<D>& s, std::uint32_t p) {
  const SoilPoints<D>& soil = s.soil;
  const SoilMaterial& material = s.constants.soils[soil.soil[p]];
  const PointKernel<D, typename S::Shape> kernel(s.grid, soil.x[p]);
  const double mass = soil.mass[p], n = soil.porosity[p];
  const double grains = mass / material.grain_density, bulk = grains / (1 - n);
  const double resistivity = s.water.size() ? bulk * material.drag.resistivity(n, discharge_of(soil, p)) : 0;
  // The hoop stress pulls towards the axis: the weak form's σθθ v_r/r.
  const double hoop = S::axial ? soil.stress[p][2] / soil.x[p][0] : 0;
  for (int d = 0; d < D; ++d) {
    const Vec<D> stress = stress_row<D>(soil.stress[p], d);
    for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
      FaceSums& f = s.sums[d][face];
      const double w = weight.w;
      double divergence = 0;
      for (int j = 0; j < D; ++j) divergence += stress[j] * weight.gradient[j];
      if (S::axial && d == 0) divergence += w * hoop;
      f.soil_mass += w * mass;
      f.grains += w * grains;
      f.soil_bulk += w * bulk;
      f.soil_momentum += sign * w * mass * velocity_at_face<S>(soil, p, d, weight);
      f.soil_force -= sign * bulk * divergence;  // [FMS19] eq. (1), ∇·σ′ in its weak form
      f.resistivity += w * resistivity;
      if (sign < 0) s.image[d][face].soil += 2 * w * mass;
    });
  }
  // Room is measured with the water's own kernels, so that grains and water fold at the same walls.
  for_centers(s.grid, s.water_walls, kernel, [&](int cell, double w) {
    s.cell_sums[cell].grains += w * grains;
    s.cell_sums[cell].soil_bulk += w * bulk;
  });
}

template <class S, int D>
void water_to_faces(State<D>& s, std::uint32_t p) {
  const PointKernel<D, typename S::Shape> kernel(s.grid, s.water.x[p]);
  const double mass = s.water.mass[p], volume = mass / s.constants.water_density;
  for (int d = 0; d < D; ++d) {
    for_faces(s.grid, s.water_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
      FaceSums& f = s.sums[d][face];
      const double w = weight.w;
      f.water_mass += w * mass;
      f.water_momentum += sign * w * mass * velocity_at_face<S>(s.water, p, d, weight);
      if (sign < 0) s.image[d][face].water += 2 * w * mass;
    });
  }
  for_centers(s.grid, s.water_walls, kernel,
              [&](int cell, double w) { s.cell_sums[cell].water += w * volume; });
}

}  // namespace

template <int D>
void points_to_faces(State<D>& s) {
  if (s.plates_left_rows) mark_plates(s);
  activate_blocks(s);
  const bool has_fixed = s.fixed.size() > 0;
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, true, [&](int i, const Cell<D>&) {
      for (int d = 0; d < D; ++d) {
        s.sums[d][i] = {};
        s.image[d][i] = {};
        s.soil_walls.commit_separated(d, i);
      }
      s.cell_sums[i] = has_fixed ? s.fixed_cell[i] : CellSums{};
    });
  });
  with_scheme(s, [&](auto scheme) {
    using S = decltype(scheme);
    s.blocks.by_color([&](int b) {
      for (auto i = s.soil_blocks.begin[b]; i < s.soil_blocks.begin[b + 1]; ++i)
        soil_to_faces<S>(s, s.soil_blocks.order[i]);
      for (auto i = s.water_blocks.begin[b]; i < s.water_blocks.begin[b + 1]; ++i)
        water_to_faces<S>(s, s.water_blocks.order[i]);
    });
  });
  loads_to_faces(s);
  fold_plates(s);
  if (s.constants.kernel == Kernel::linear) join_light_faces(s);
}

namespace {

template <class Shape, int D>
void measure_fixed_with(State<D>& s) {
  for (auto& f : s.fixed_face) f = Field<FixedFace>(s.grid.count());
  s.fixed_cell = Field<CellSums>(s.grid.count());
  for (std::size_t p = 0; p < s.fixed.size(); ++p) {
    const SoilMaterial& material = s.constants.soils[s.fixed.soil[p]];
    const PointKernel<D, Shape> kernel(s.grid, s.fixed.x[p]);
    const double n = s.fixed.porosity[p], grains = s.fixed.mass[p] / material.grain_density;
    const double bulk = grains / (1 - n),
                 resistivity = material.drag.resistivity(n, discharge_of(s.fixed, p));
    for (int d = 0; d < D; ++d)
      for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, double w, double, const Vec<D>&) {
        const double volume = s.volume.face(d, face);
        s.fixed_face[d][face].phi += w * grains / volume;
        s.fixed_face[d][face].bulk += w * bulk / volume;
        s.fixed_face[d][face].resistivity += w * bulk * resistivity / volume;
      });
    for_centers(s.grid, s.water_walls, kernel, [&](int cell, double w) {
      s.fixed_cell[cell].grains += w * grains;
      s.fixed_cell[cell].soil_bulk += w * bulk;
    });
  }
}

}  // namespace

template <int D>
void measure_fixed(State<D>& s) {
  with_kernel(s.constants.kernel, [&](auto shape) { measure_fixed_with<decltype(shape)>(s); });
}

template void points_to_faces<2>(State<2>&);
template void points_to_faces<3>(State<3>&);
template void measure_fixed<2>(State<2>&);
template void measure_fixed<3>(State<3>&);

}  // namespace quicksand

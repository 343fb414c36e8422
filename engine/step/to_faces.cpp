// Points → faces and cells: masses, momenta, internal forces, drag, volumes.

#include "engine/step/batches.hpp"
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

/// What a soil point leaves on faces of one component, per weight w and gradient g:
/// w `carried`, and the force −bulk (σ·g + w hoop) with w `resistivity`.
template <int D>
struct SoilShare {
  Lanes<4> carried;  ///< mass, grains, bulk, momentum
  Vec<D> stress;     ///< −bulk × row of the stress, [FMS19] eq. (1), ∇·σ′ in its weak form
  double hoop = 0;   ///< the same of σθθ/r, which pulls towards the axis: the weak form's σθθ v_r/r
  double resistivity = 0;
};

template <int D, class Row>
QUICKSAND_INLINE void add_row(Field<FaceSums>& sums, const Row& row, const SoilShare<D>& share) {
  const Lanes<4> carried = row.w * share.carried;
  double across = row.w * share.hoop;
  for (int j = 1; j < D; ++j) across += share.stress[j] * row.gradient[j];
  const Lanes<2> with_weight{across, row.w * share.resistivity},
      with_slope{share.stress[0] * row.gradient[0], 0};
  for (std::size_t i = 0; i < row.x.size(); ++i) {
    FaceSums& f = sums[row.first + i];
    add_lanes<4>(f.soil_mass, row.x[i] * carried);
    add_lanes<2>(f.soil_force, row.x[i] * with_weight + row.dx[i] * with_slope);
  }
}

template <class S, int D, class Kernel>
void soil_to_faces(State<D>& s, std::uint32_t p, const Kernel& kernel) {
  const SoilPoints<D>& soil = s.soil;
  const SoilMaterial& material = s.constants.soils[soil.soil[p]];
  const double mass = soil.mass[p], n = soil.porosity[p];
  const double grains = mass / material.grain_density, bulk = grains / (1 - n);
  const double resistivity = s.has_water ? bulk * material.drag.resistivity(n, discharge_of(soil, p)) : 0;
  const bool open = !S::affine && !s.soil_walls.folds(kernel.home());
  for_components<D>([&](auto d) {
    SoilShare<D> share{
        {mass, grains, bulk, mass * soil.v[p][d]}, stress_row<D>(soil.stress[p], d), 0, resistivity};
    for (double& component : share.stress) component *= -bulk;
    if (S::axial && d == 0) share.hoop = -bulk * soil.stress[p][2] / soil.x[p][0];
    if (open) {
      for_rows(s.grid, kernel, d, [&](const auto& row) { add_row<D>(s.sums[d], row, share); });
      return;
    }
    for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
      FaceSums& f = s.sums[d][face];
      const double w = weight.w, momentum = sign * mass * velocity_at_face<S>(soil, p, d, weight);
      double force = w * share.hoop;
      for (int j = 0; j < D; ++j) force += share.stress[j] * weight.gradient[j];
      add_lanes<4>(f.soil_mass, w * Lanes<4>{mass, grains, bulk, momentum});
      add_lanes<2>(f.soil_force, Lanes<2>{sign * force, w * resistivity});
      if (sign < 0) s.image[d][face].soil += 2 * w * mass;
    });
  });
  // Room is measured with the water's own kernels, so that grains and water fold at the same walls.
  const Lanes<2> room{grains, bulk};
  for_centers(s.grid, s.water_walls, kernel,
              [&](int cell, double w) { add_lanes<2>(s.cell_sums[cell].grains, w * room); });
}

template <class S, int D, class Kernel>
void water_to_faces(State<D>& s, std::uint32_t p, const Kernel& kernel) {
  const double mass = s.water.mass[p], volume = mass / s.constants.water_density;
  const bool open = !S::affine && !s.water_walls.folds(kernel.home());
  for_components<D>([&](auto d) {
    if (open) {
      const Lanes<2> carried{mass, mass * s.water.v[p][d]};
      for_rows(s.grid, kernel, d, [&](const auto& row) {
        const Lanes<2> share = row.w * carried;
        for (std::size_t i = 0; i < row.x.size(); ++i)
          add_lanes<2>(s.sums[d][row.first + i].water_mass, row.x[i] * share);
      });
      return;
    }
    for_faces(s.grid, s.water_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
      const double w = weight.w, momentum = sign * mass * velocity_at_face<S>(s.water, p, d, weight);
      add_lanes<2>(s.sums[d][face].water_mass, w * Lanes<2>{mass, momentum});
      if (sign < 0) s.image[d][face].water += 2 * w * mass;
    });
  });
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
        FaceImage& image = s.image[d][i];  // but beside walls it stays as it is, untouched in memory
        if (image.soil != 0 || image.water != 0) image = {};
        s.soil_walls.commit_separated(d, i);
      }
      s.cell_sums[i] = has_fixed ? s.fixed_cell[i] : CellSums{};
    });
  });
  with_scheme(s, [&](auto scheme) {
    using S = decltype(scheme);
    using Shape = typename S::Shape;
    s.blocks.by_color([&](int b) {
      for_points<Shape>(s.grid, s.soil.x, s.soil_blocks, b,
                        [&](std::uint32_t p, const auto& kernel) { soil_to_faces<S>(s, p, kernel); });
      for_points<Shape>(s.grid, s.water.x, s.water_blocks, b,
                        [&](std::uint32_t p, const auto& kernel) { water_to_faces<S>(s, p, kernel); });
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

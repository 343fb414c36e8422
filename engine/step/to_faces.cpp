// Points → faces and cells: masses, momenta, internal forces, drag, volumes.

#include "engine/grid/stencil.hpp"
#include "engine/step/batches.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

/// Row d of a symmetric tensor.
template <int D>
QUICKSAND_INLINE std::array<BatchLanes, D> stress_row(const Stress<D, BatchLanes>& s, int d) {
  constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  std::array<BatchLanes, D> row;
  for (int j = 0; j < D; ++j) row[j] = s[at[d][j]];
  return row;
}

/// m/s, for drag that follows it.
template <int D>
double discharge_of(const SoilPoints<D>& soil, std::size_t p) {
  return soil.discharge.empty() ? 0 : soil.discharge[p];
}

/// Lanes of FaceSums. While soil is summed, that of the water's mass, which it does not have, takes the part
/// of the force that goes with the derivative along the component's own axis, so that one product does for
/// all of a node.
constexpr int kMomentum = 3, kForce = 4, kOwnForce = 6;
Lanes<8> unit(int lane) {
  Lanes<8> v{};
  v[lane] = 1;
  return v;
}

/// Of a batch of soil points.
template <int D>
struct SoilShare {
  BatchLanes mass, grains, bulk, resistivity{};  ///< kg, m³, m³, N·s/m
  Stress<D, BatchLanes> force;                   ///< N, −bulk × stress / h
};

template <int D>
QUICKSAND_INLINE SoilShare<D> soil_share(const State<D>& s, const PointBatch<D>& batch) {
  const SoilPoints<D>& soil = s.soil;
  const auto& soils = s.constants.soils;
  BatchLanes density = all_lanes<BatchLanes>(soils.front().grain_density);
  if (soils.size() > 1)
    for (int k = 0; k < kBatch; ++k) density[k] = soils[soil.soil[batch.point[k]]].grain_density;
  SoilShare<D> share;
  const BatchLanes n = batch.get(soil.porosity);
  share.mass = batch.get(soil.mass);
  share.grains = share.mass / density;
  share.bulk = share.grains / (1.0 - n);
  if (s.has_water)
    for (int k = 0; k < batch.count; ++k) {
      const std::uint32_t p = batch.point[k];
      share.resistivity[k] =
          share.bulk[k] * soils[soil.soil[p]].drag.resistivity(n[k], discharge_of(soil, p));
    }
  share.force = batch.get(soil.stress);
  const BatchLanes per_cell = -s.grid.inverse_h * share.bulk;
  for (BatchLanes& component : share.force) component *= per_cell;
  return share;
}

/// What soil point k leaves on the window of component d, by node: `carried` in the order of FaceSums, and
/// the forces per derivative of its weights (per cell), [FMS19] eq. (1), ∇·σ′ in its weak form.
template <class S, int d, int D, class Kernel>
QUICKSAND_INLINE void add_soil(const Kernel& kernel, int k, const Lanes<8>& carried,
                               const std::array<BatchLanes, D>& force, double h, const Vec<D>* gradient,
                               std::array<Lanes<8>, CellWindow<D>::kFaces>& sums) {
  const auto& own = kernel.face[d];
  const auto& other = kernel.center[axis_of(d, 1)];
  const auto& last = kernel.center[axis_of(d, D - 1)];
  const auto own_force = unit(kOwnForce) > 0.5;
  std::array<Lanes<8>, 4> along;
  for (int x = 0; x < 4; ++x)
    along[x] = where(own_force, all_lanes<Lanes<8>>(own.dw[x][k]), all_lanes<Lanes<8>>(own.w[x][k]));
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      double w = other.w[y][k], across = other.dw[y][k] * force[axis_of(d, 1)][k];
      if constexpr (D == 3) {
        across = across * last.w[z][k] + w * last.dw[z][k] * force[axis_of(d, 2)][k];
        w *= last.w[z][k];
      }
      Lanes<8> row = w * carried + across * unit(kForce);
      Lanes<8> turning{};         // momentum per arm along the own axis
      if constexpr (S::affine) {  // [JSSTS15] eq. (8), per component of the staggered grid
        const double mass = w * carried[0] * h;
        double arms = (*gradient)[axis_of(d, 1)] * (y - 1 - other.at[k]);
        if constexpr (D == 3) arms += (*gradient)[axis_of(d, 2)] * (z - 1 - last.at[k]);
        row += mass * arms * unit(kMomentum);
        turning = mass * (*gradient)[d] * unit(kMomentum);
      }
      for (int x = 0; x < 4; ++x) {
        Lanes<8>& sum = sums[x + 4 * (y + 3 * z)];
        sum += along[x] * row;
        if constexpr (S::affine) sum += own.w[x][k] * (x - 1 - own.at[k]) * turning;
      }
    }
}

/// Adds w × value of point k to the window of centres.
template <int D, class Kernel, class T>
QUICKSAND_INLINE void add_to_centers(const Kernel& kernel, int k, const T& value,
                                     std::array<T, CellWindow<D>::kCenters>& sums) {
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      const T row =
          (D == 2 ? kernel.center[1].w[y][k] : kernel.center[1].w[y][k] * kernel.center[D - 1].w[z][k]) *
          value;
      for (int x = 0; x < 3; ++x) sums[x + 3 * (y + 3 * z)] += kernel.center[0].w[x][k] * row;
    }
}

template <class S, int D>
void soil_to_faces(State<D>& s, const Cell<D>& cell, const PointBatch<D>& batch) {
  const std::array<BatchLanes, D> x = batch.get(s.soil.x), v = batch.get(s.soil.v);
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, cell, x);
  const SoilShare<D> share = soil_share(s, batch);
  const int home = s.grid.index(cell);
  const CellWindow<D> window(s.grid, s.soil_walls, home);
  const Lanes<8> kept{1, 1, 1, 1, 1, 1, 0, 0}, turned{1, 1, 1, -1, -1, 1, 0, 0};
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    BatchLanes hoop{};  // about an axis σθθ/r pulls towards it: the weak form's σθθ v_r/r
    if constexpr (S::axial && d == 0) hoop = s.grid.h * share.force[2] / x[0];
    const std::array<BatchLanes, D> force = stress_row<D>(share.force, d);
    const std::array<Lanes<8>, 8> carried =
        transposed({share.mass, share.grains, share.bulk, share.mass * v[d], hoop, share.resistivity,
                    force[d], BatchLanes{}});
    std::array<Lanes<8>, CellWindow<D>::kFaces> sums{};
    for (int k = 0; k < batch.count; ++k)
      add_soil<S, d, D>(kernel, k, carried[k], force, s.grid.h,
                        S::affine ? &s.soil.affine[batch.point[k]][d] : nullptr, sums);
    window.faces(
        d, [&](int node, int face, double sign) __attribute__((always_inline)) {
          const Lanes<8> sum =
              sums[node] + __builtin_shufflevector(sums[node], sums[node], 7, 7, 7, 7, kOwnForce, 7, 7, 7);
          add_lanes<8>(s.sums[d][face].soil_mass, (sign < 0 ? turned : kept) * sum);
          if (sign < 0) s.image[d][face].soil += 2 * sum[0];
        });
  });
  if (!s.counts_room) return;
  // Room is measured with the water's own kernels, so that grains and water fold at the same walls.
  std::array<Lanes<2>, CellWindow<D>::kCenters> room{};
  for (int k = 0; k < batch.count; ++k)
    add_to_centers<D>(kernel, k, Lanes<2>{share.grains[k], share.bulk[k]}, room);
  CellWindow<D>(s.grid, s.water_walls, home).centers([&](int node, int to) __attribute__((always_inline)) {
    add_lanes<2>(s.cell_sums[to].grains, room[node]);
  });
}

/// What a water point leaves on the window of component d: mass and momentum.
template <class S, int d, int D, class Kernel>
QUICKSAND_INLINE void add_water(const State<D>& s, const Kernel& kernel, int k, std::uint32_t p,
                                std::array<Lanes<2>, CellWindow<D>::kFaces>& sums) {
  const double mass = s.water.mass[p];
  const Lanes<2> carried{mass, mass * s.water.v[p][d]};
  const auto& own = kernel.face[d];
  const auto& other = kernel.center[axis_of(d, 1)];
  const auto& last = kernel.center[axis_of(d, D - 1)];
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      const double w = D == 2 ? other.w[y][k] : other.w[y][k] * last.w[z][k];
      Lanes<2> row = w * carried, turning{};
      if constexpr (S::affine) {
        const Vec<D>& gradient = s.water.affine[p][d];
        const double momentum = w * mass * s.grid.h;
        double across = gradient[axis_of(d, 1)] * (y - 1 - other.at[k]);
        if constexpr (D == 3) across += gradient[axis_of(d, 2)] * (z - 1 - last.at[k]);
        row += Lanes<2>{0, momentum * across};
        turning = Lanes<2>{0, momentum * gradient[d]};
      }
      for (int x = 0; x < 4; ++x) {
        Lanes<2>& sum = sums[x + 4 * (y + 3 * z)];
        sum += own.w[x][k] * row;
        if constexpr (S::affine) sum += own.w[x][k] * (x - 1 - own.at[k]) * turning;
      }
    }
}

template <class S, int D>
void water_to_faces(State<D>& s, const Cell<D>& cell, const PointBatch<D>& batch) {
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, cell, batch.get(s.water.x));
  const CellWindow<D> window(s.grid, s.water_walls, s.grid.index(cell));
  for_components<D>([&](auto d) {
    std::array<Lanes<2>, CellWindow<D>::kFaces> sums{};
    for (int k = 0; k < batch.count; ++k) add_water<S, d>(s, kernel, k, batch.point[k], sums);
    window.faces(
        d, [&](int node, int face, double sign) __attribute__((always_inline)) {
          add_lanes<2>(s.sums[d][face].water_mass, Lanes<2>{1, sign} * sums[node]);
          if (sign < 0) s.image[d][face].water += 2 * sums[node][0];
        });
  });
  std::array<double, CellWindow<D>::kCenters> volume{};
  for (int k = 0; k < batch.count; ++k)
    add_to_centers<D>(kernel, k, s.water.mass[batch.point[k]] / s.constants.water_density, volume);
  window.centers([&](int node, int to)
                     __attribute__((always_inline)) { s.cell_sums[to].water += volume[node]; });
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
      if (s.counts_room) s.cell_sums[i] = has_fixed ? s.fixed_cell[i] : CellSums{};
    });
  });
  with_scheme(s, [&](auto scheme) {
    using S = decltype(scheme);
    s.blocks.by_color([&](int b) {
      for_batches(s.blocks, s.soil_blocks, b, [&](const Cell<D>& cell, const PointBatch<D>& batch) {
        soil_to_faces<S, D>(s, cell, batch);
      });
      for_batches(s.blocks, s.water_blocks, b, [&](const Cell<D>& cell, const PointBatch<D>& batch) {
        water_to_faces<S, D>(s, cell, batch);
      });
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

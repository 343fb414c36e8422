#pragma once
// Grains → faces and cells: mass, volumes, momentum, the force of the effective stress, resistance to water.

#include "engine/step/batches.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// m/s, for drag that follows it.
template <int D>
double discharge_of(const SoilPoints<D>& soil, std::size_t p) {
  return soil.discharge.empty() ? 0 : soil.discharge[p];
}

/// Lanes of FaceSums while soil is summed. Those of the water's mass and momentum, which soil does not have,
/// take what goes with other factors along the component's own axis than the weight: part of the force with
/// its derivative, part of the momentum with the arm. So one product does for all of a node.
constexpr int kMomentum = 3, kForce = 4, kOwnForce = 6, kOwnMomentum = 7;
constexpr Lanes<8> kUnitMomentum{0, 0, 0, 1, 0, 0, 0, 0}, kUnitForce{0, 0, 0, 0, 1, 0, 0, 0};

/// Of a batch of soil points.
template <int D>
struct SoilShare {
  BatchLanes mass, grains, bulk, resistivity{};  ///< kg, m³, m³, N·s/m
  Stress<D, BatchLanes> force;                   ///< N, −bulk × stress / h
  /// Of the stress's row d.
  BatchLanes row(int d, int j) const {
    constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    return force[at[d][j]];
  }
};

/// ρw g/k, N·s/m⁴.
template <int D>
QUICKSAND_INLINE BatchLanes resistivity_of(const State<D>& s, const PointBatch<D>& batch,
                                           const BatchLanes& n) {
  const auto& soils = s.constants.soils;
  if (soils.size() == 1 && s.soil.discharge.empty()) return soils.front().drag.resistivity(n);
  BatchLanes r{};
  for (int k = 0; k < batch.count; ++k) {
    const std::uint32_t p = batch.point[k];
    r[k] = soils[s.soil.soil[p]].drag.resistivity(n[k], discharge_of(s.soil, p));
  }
  return r;
}

template <int D>
QUICKSAND_INLINE SoilShare<D> soil_share(const State<D>& s, const PointBatch<D>& batch) {
  const SoilPoints<D>& soil = s.soil;
  const auto& soils = s.constants.soils;
  BatchLanes specific = all_lanes<BatchLanes>(1 / soils.front().grain_density);  // m³/kg
  if (soils.size() > 1)
    for (int k = 0; k < kBatch; ++k) specific[k] = 1 / soils[soil.soil[batch.point[k]]].grain_density;
  SoilShare<D> share;
  const BatchLanes n = batch.get(soil.porosity);
  share.mass = batch.get(soil.mass);
  share.grains = share.mass * specific;
  share.bulk = share.grains / (1.0 - n);
  if (s.has_water) share.resistivity = batch.only(share.bulk * resistivity_of(s, batch, n));
  share.force = batch.get(soil.stress);
  const BatchLanes per_cell = -s.grid.inverse_h * share.bulk;
  for (BatchLanes& component : share.force) component *= per_cell;
  return share;
}

/// What goes with the rows of a window along the own axis of component d, [y + 3 z]: weights, and what is not
/// a multiple of them: N, force by the derivatives across, [FMS19] eq. (1), ∇·σ′ in its weak form; kg·m/s,
/// momentum by the arms across, [JSSTS15] eq. (8), per component of the staggered grid.
template <int D>
struct SoilRows {
  static constexpr int kRows = CellWindow<D>::kFaces / 4;
  std::array<BatchLanes, kRows> weight, force, momentum;

  /// `turning`: kg·m/s per cell along each axis_of(d, ·); with the affine transfer only.
  template <class S, int d, class Kernel>
  QUICKSAND_INLINE void find(const Kernel& kernel, const SoilShare<D>& share,
                             const std::array<BatchLanes, D>& turning) {
    const auto& other = kernel.center[axis_of(d, 1)];
    const auto& last = kernel.center[axis_of(d, D - 1)];
    for (int z = 0; z < CellWindow<D>::kLast; ++z)
      for (int y = 0; y < 3; ++y) {
        const int r = y + 3 * z;
        weight[r] = other.w[y];
        force[r] = other.dw[y] * share.row(d, axis_of(d, 1));
        if constexpr (D == 3) {
          weight[r] *= last.w[z];
          force[r] = force[r] * last.w[z] + other.w[y] * last.dw[z] * share.row(d, axis_of(d, 2));
        }
        if constexpr (S::affine) {
          momentum[r] = turning[1] * other.arm(y);
          if constexpr (D == 3) momentum[r] += turning[2] * last.arm(z);
          momentum[r] *= weight[r];
        }
      }
  }
};

/// kg·m/s per cell along each axis_of(d, ·), of component d.
template <int d, int D>
QUICKSAND_INLINE std::array<BatchLanes, D> turning_of(const PointSet<D>& set, const PointBatch<D>& batch,
                                                      const BatchLanes& mass, double h) {
  std::array<BatchLanes, D> turning{};
  for (int k = 0; k < batch.count; ++k)
    for (int j = 0; j < D; ++j) turning[j][k] = set.affine[batch.point[k]][d][axis_of(d, j)];
  for (BatchLanes& t : turning) t *= h * mass;
  return turning;
}

/// Adds what point k leaves on the window: `carried` in the order of FaceSums.
template <class S, int D>
QUICKSAND_INLINE void add_soil(const WindowNodes<4>& own, const SoilRows<D>& rows, int k,
                               const Lanes<8>& carried, std::array<Lanes<8>, CellWindow<D>::kFaces>& sums) {
  const auto by_slope = Lanes<8>{0, 0, 0, 0, 0, 0, 1, 0} > 0, by_arm = Lanes<8>{0, 0, 0, 0, 0, 0, 0, 1} > 0;
  std::array<Lanes<8>, 4> along;
  for (int x = 0; x < 4; ++x) {
    along[x] = where(by_slope, all_lanes<Lanes<8>>(own.dw[x][k]), all_lanes<Lanes<8>>(own.w[x][k]));
    if constexpr (S::affine)
      along[x] = where(by_arm, all_lanes<Lanes<8>>(own.w[x][k] * (x - 1 - own.at[k])), along[x]);
  }
  for (int r = 0; r < SoilRows<D>::kRows; ++r) {
    Lanes<8> row = rows.weight[r][k] * carried + rows.force[r][k] * kUnitForce;
    if constexpr (S::affine) row += rows.momentum[r][k] * kUnitMomentum;
    for (int x = 0; x < 4; ++x) sums[x + 4 * r] += along[x] * row;
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
void soil_to_faces(State<D>& s, const PointBatch<D>& batch) {
  const std::array<BatchLanes, D> x = batch.get(s.soil.x), v = batch.get(s.soil.v);
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, batch.places(), x);
  const SoilShare<D> share = soil_share(s, batch);
  const BatchWindows<D> windows(s.grid, s.soil_walls, batch);
  const Lanes<8> kept{1, 1, 1, 1, 1, 1, 0, 0}, turned{1, 1, 1, -1, -1, 1, 0, 0};
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    BatchLanes hoop{};  // about an axis σθθ/r pulls towards it: the weak form's σθθ v_r/r
    if constexpr (S::axial && d == 0) hoop = s.grid.h * share.force[2] / x[0];
    std::array<BatchLanes, D> turning{};
    if constexpr (S::affine) turning = turning_of<d, D>(s.soil, batch, share.mass, s.grid.h);
    SoilRows<D> rows;
    rows.template find<S, d>(kernel, share, turning);
    const std::array<Lanes<8>, 8> carried =
        transposed({share.mass, share.grains, share.bulk, share.mass * v[d], hoop, share.resistivity,
                    share.row(d, d), turning[0]});
    windows.each(
        batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
          std::array<Lanes<8>, CellWindow<D>::kFaces> sums{};
          for (int k = from; k < to; ++k) add_soil<S, D>(kernel.face[d], rows, k, carried[k], sums);
          window.faces(
              d, [&](int node, int face, double sign) __attribute__((always_inline)) {
                const Lanes<8> own = __builtin_shufflevector(
                    sums[node], Lanes<8>{}, 8, 8, 8, S::affine ? kOwnMomentum : 8, kOwnForce, 8, 8, 8);
                add_lanes<8>(s.sums[d][face].soil_mass, (sign < 0 ? turned : kept) * (sums[node] + own));
                if (sign < 0) s.image[d][face].soil += 2 * sums[node][0];
              });
        });
  });
  if (!s.counts_room) return;
  // Room is measured with the water's own kernels, so that grains and water fold at the same walls.
  const BatchWindows<D> cells(s.grid, s.water_walls, batch);
  cells.each(
      batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
        std::array<Lanes<2>, CellWindow<D>::kCenters> room{};
        for (int k = from; k < to; ++k)
          add_to_centers<D>(kernel, k, Lanes<2>{share.grains[k], share.bulk[k]}, room);
        window.centers([&](int node, int cell) __attribute__((always_inline)) {
          add_lanes<2>(s.cell_sums[cell].grains, room[node]);
        });
      });
}

}  // namespace quicksand

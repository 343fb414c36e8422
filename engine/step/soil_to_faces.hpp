#pragma once
// Grains → faces and cells: mass, volumes, momentum, the force of the effective stress, resistance to water.

#include "engine/step/mass_to_faces.hpp"

namespace quicksand {

template <>
inline constexpr bool kLastIsOfVector<RoomSum> = false;

/// m/s, for drag that follows it.
template <int D>
double discharge_of(const SoilPoints<D>& soil, std::size_t p) {
  return soil.discharge.empty() ? 0 : soil.discharge[p];
}

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
  Kept<> r = BatchLanes{};
  for (int k = 0; k < batch.count; ++k) {
    const std::uint32_t p = batch.point[k];
    r[k] = soils[s.soil.soil[p]].drag.resistivity(n[k], discharge_of(s.soil, p));
  }
  return r.lanes();
}

template <int D>
QUICKSAND_INLINE SoilShare<D> soil_share(const State<D>& s, const PointBatch<D>& batch) {
  const SoilPoints<D>& soil = s.soil;
  const auto& soils = s.constants.soils;
  BatchLanes specific = all_lanes<BatchLanes>(1 / soils.front().grain_density);  // m³/kg
  if (soils.size() > 1)
    specific = lanes_of<kBatch>([&](int k) { return 1 / soils[soil.soil[batch.point[k]]].grain_density; });
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

/// N, force by the derivatives across, [FMS19] eq. (1), ∇·σ′ in its weak form: what goes with the rows of
/// component d's window beside their weights. About an axis σθθ/r pulls towards it, the weak form's σθθ
/// v_r/r.
template <class S, int d, int D, class Kernel>
QUICKSAND_INLINE RowFactors<WindowRows<d, D>::count> forces_across(const Kernel& kernel,
                                                                   const SoilShare<D>& share,
                                                                   const BatchLanes& hoop) {
  RowFactors<WindowRows<d, D>::count> force;
  const auto& second = nodes_along<d, 1>(kernel);
  const auto& third = nodes_along<d, D - 1>(kernel);
  for_rows<d, D>([&](auto r, auto y, auto z) __attribute__((always_inline)) {
    BatchLanes f = second.dw[y] * share.row(d, 1);
    if constexpr (D == 3) f = f * third.w[z] + second.w[y] * third.dw[z] * share.row(d, 2);
    if constexpr (S::axial && d == 0) f += second.w[y] * hoop;
    force[r] = f;
  });
  return force;
}

/// Weights of points on the nodes along x, on four faces or three centres, and with their derivatives.
struct AlongX {
  NodesByPoint<2> twice, with_slopes;  ///< pairs {w, w} and, with water, {w, dw}
  NodesByPoint<1> weights, slopes;     ///< without water
  template <int n>
  QUICKSAND_INLINE AlongX(const WindowNodes<n>& nodes, bool has_water) : twice(by_point(nodes.w, nodes.w)) {
    if (has_water)
      with_slopes = by_point(nodes.w, nodes.dw);
    else
      weights = by_point(nodes.w), slopes = by_point(nodes.dw);
  }
};

/// The force of the stress on the rows of a window.
template <int rows>
struct ForceRows {
  const AlongX& nodes;
  const RowFactors<rows>& weight;
  RowFactors<rows> across;  ///< N
  Kept<> own;               ///< N, by the derivatives along x
  /// N.
  QUICKSAND_INLINE RowSums<rows, 1> sums(int from, int to) const {
    const auto along = [&](int k) __attribute__((always_inline)) { return nodes.slopes[k] * own[k]; };
    const auto beside = [&](int k) __attribute__((always_inline)) { return nodes.weights[k]; };
    return sum_points<1>(from, to, Term(weight, along), Term(across, beside));
  }
  /// ForceSum; `pair` is the resistivity and `own`.
  QUICKSAND_INLINE RowSums<rows> sums_with(const PairsByPoint& pair, int from, int to) const {
    const auto along = [&](int k) __attribute__((always_inline)) { return nodes.with_slopes[k] * pair[k]; };
    const auto beside = [&](int k) __attribute__((always_inline)) {
      return nodes.twice[k] * second_of_pairs(1);
    };
    return sum_points<2>(from, to, Term(weight, along), Term(across, beside));
  }
};

/// What a batch leaves on the faces of component d.
template <class S, int d, int D, class Kernel>
QUICKSAND_INLINE void soil_to_component(State<D>& s, const PointBatch<D>& batch,
                                        const BatchWindows<D>& windows, const Kernel& kernel,
                                        const AlongX& nodes, const SoilShare<D>& share, const BatchLanes& v,
                                        const BatchLanes& hoop) {
  const MassRows<S, d, D> mass(kernel, share.mass, v, turning_of<S, d>(s.soil, batch, share.mass, s.grid.h));
  const ForceRows<WindowRows<d, D>::count> force{
      nodes, mass.weight, forces_across<S, d, D>(kernel, share, hoop), share.row(d, 0)};
  PairsByPoint resisted, room;  // with water
  if (s.has_water) resisted = {share.resistivity, share.row(d, 0)}, room = {share.grains, share.bulk};
  const auto taken = [&](int k) __attribute__((always_inline)) { return nodes.twice[k] * room[k]; };
  const auto mirrored = [&](int face, double m) { s.image[d][face].soil += 2 * m; };
  const auto nothing = [](int, double) {};
  FaceSumFields& sums = s.sums[d];
  windows.each(
      batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
        add_to_faces<d>(s.grid, window, mass.sums(nodes.twice, from, to), sums.soil, mirrored);
        if (!s.has_water) {
          add_to_faces<d>(s.grid, window, force.sums(from, to), sums.stress, nothing);
          return;
        }
        add_to_faces<d>(s.grid, window, force.sums_with(resisted, from, to), sums.force, nothing);
        add_to_faces<d>(s.grid, window, sum_points<2>(from, to, Term(mass.weight, taken)), sums.room,
                        nothing);
      });
}

/// What a batch takes of the cells' room.
template <int D, class Kernel>
QUICKSAND_INLINE void soil_to_cells(State<D>& s, const PointBatch<D>& batch, const Kernel& kernel,
                                    const NodesByPoint<2>& centers, const SoilShare<D>& share) {
  // Measured with the water's own kernels, so that grains and water fold at the same walls.
  const BatchWindows<D> cells(s.grid, s.water_walls, batch);
  const PairsByPoint room(share.grains, share.bulk);
  const auto weight = row_weights<0, D>(kernel);
  const auto taken = [&](int k) __attribute__((always_inline)) { return centers[k] * room[k]; };
  const auto add = [&](int cell, const double* pair) __attribute__((always_inline)) {
    add_lanes<2>(s.cell_sums[cell].grains, lanes_from<2>(*pair));
  };
  cells.each(
      batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
        for_centers_of<2>(window, sum_points<2>(from, to, Term(weight, taken)), add);
      });
}

template <class S, int D>
void soil_to_faces(State<D>& s, const PointBatch<D>& batch) {
  const std::array<BatchLanes, D> x = batch.get(s.soil.x), v = batch.get(s.soil.v);
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, batch.places(), x);
  const SoilShare<D> share = soil_share(s, batch);
  const BatchWindows<D> windows(s.grid, s.soil_walls, batch);
  const AlongX faces(kernel.face[0], s.has_water), centers(kernel.center[0], s.has_water);
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    BatchLanes hoop{};
    if constexpr (S::axial && d == 0) hoop = s.grid.h * share.force[2] / x[0];
    soil_to_component<S, d>(s, batch, windows, kernel, d == 0 ? faces : centers, share, v[d], hoop);
  });
  if (s.counts_room) soil_to_cells(s, batch, kernel, centers.twice, share);
}

}  // namespace quicksand

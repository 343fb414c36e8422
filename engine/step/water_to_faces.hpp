#pragma once
// Water → faces and cells: mass, momentum, volume.

#include "engine/step/batches.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// What water points leave on a window of component d, four nodes of a row at once: mass and momentum of one
/// node side by side.
template <int D>
using WaterRows = std::array<Lanes<8>, CellWindow<D>::kFaces / 4>;

/// Of a batch along the own axis, point by point: mass and momentum of the four nodes, less the weights
/// across. With the affine transfer `turning` is in it, kg·m/s per cell along the own axis.
template <class S>
QUICKSAND_INLINE std::array<Lanes<8>, 8> water_along(const WindowNodes<4>& own, const BatchLanes& mass,
                                                     const BatchLanes& momentum, const BatchLanes& turning) {
  std::array<BatchLanes, 8> of;
  for (int x = 0; x < 4; ++x) {
    of[2 * x] = own.w[x] * mass;
    of[2 * x + 1] = own.w[x] * momentum;
    if constexpr (S::affine) of[2 * x + 1] += own.w[x] * own.arm(x) * turning;
  }
  return transposed(of);
}

/// Masses of a batch's points at the nodes along the own axis where only momentum goes, point by point.
QUICKSAND_INLINE std::array<Lanes<8>, 8> weights_of_momentum(const WindowNodes<4>& own) {
  const BatchLanes none{};
  return transposed({none, own.w[0], none, own.w[1], none, own.w[2], none, own.w[3]});
}

/// Σ of the batch on the window of component d.
template <class S, int d, int D, class Kernel>
QUICKSAND_INLINE WaterRows<D> water_rows(const State<D>& s, const Kernel& kernel, const PointBatch<D>& batch,
                                         const BatchLanes& mass, const BatchLanes& v) {
  const auto& other = kernel.center[axis_of(d, 1)];
  const auto& last = kernel.center[axis_of(d, D - 1)];
  std::array<BatchLanes, D> turning{};
  if constexpr (S::affine) turning = turning_of<d, D>(s.water, batch, mass, s.grid.h);
  const std::array<Lanes<8>, 8> along = water_along<S>(kernel.face[d], mass, mass * v, turning[0]);
  std::array<Lanes<8>, 8> turned;
  if constexpr (S::affine) turned = weights_of_momentum(kernel.face[d]);
  WaterRows<D> rows{};
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      Lanes<8>& row = rows[y + 3 * z];
      const BatchLanes w = D == 2 ? other.w[y] : other.w[y] * last.w[z];
      for (int k = 0; k < batch.count; ++k) row += w[k] * along[k];
      if constexpr (S::affine) {
        BatchLanes across = turning[1] * other.arm(y);
        if constexpr (D == 3) across += turning[2] * last.arm(z);
        across *= w;
        for (int k = 0; k < batch.count; ++k) row += across[k] * turned[k];
      }
    }
  return rows;
}

template <class S, int D>
void water_to_faces(State<D>& s, const Cell<D>& cell, const PointBatch<D>& batch) {
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, cell, batch.get(s.water.x));
  const CellWindow<D> window(s.grid, s.water_walls, s.grid.index(cell));
  const BatchLanes mass = batch.only(batch.get(s.water.mass));
  const std::array<BatchLanes, D> v = batch.get(s.water.v);
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    const WaterRows<D> rows = water_rows<S, d, D>(s, kernel, batch, mass, v[d]);
    window.faces(
        d, [&](int node, int face, double sign) __attribute__((always_inline)) {
          const Lanes<8>& row = rows[node / 4];
          const int x = 2 * (node % 4);
          add_lanes<2>(s.sums[d][face].water_mass, Lanes<2>{row[x], sign * row[x + 1]});
          if (sign < 0) s.image[d][face].water += 2 * row[x];
        });
  });
  // Volumes of the points in the three cells of a row, [3] of it unused.
  const auto& across = kernel.center;
  const BatchLanes volume = mass / s.constants.water_density, none{};
  const std::array<Lanes<8>, 8> along = transposed({across[0].w[0] * volume, across[0].w[1] * volume,
                                                    across[0].w[2] * volume, none, none, none, none, none});
  std::array<Lanes<4>, CellWindow<D>::kCenters / 3> volumes{};
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      const BatchLanes w = D == 2 ? across[1].w[y] : across[1].w[y] * across[D - 1].w[z];
      for (int k = 0; k < batch.count; ++k)
        volumes[y + 3 * z] += w[k] * __builtin_shufflevector(along[k], along[k], 0, 1, 2, 3);
    }
  window.centers([&](int node, int to) __attribute__((always_inline)) {
    s.cell_sums[to].water += volumes[node / 3][node % 3];
  });
}

}  // namespace quicksand

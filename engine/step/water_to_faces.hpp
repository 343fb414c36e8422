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

/// kg·m/s per cell, of the water; zeros without the affine transfer.
template <class S, int d, int D>
QUICKSAND_INLINE std::array<BatchLanes, D> turning_if(const State<D>& s, const PointBatch<D>& batch,
                                                      const BatchLanes& mass) {
  if constexpr (S::affine)
    return turning_of<d, D>(s.water, batch, mass, s.grid.h);
  else
    return {};
}

/// What goes with a batch's points along component d's own axis and across it.
template <class S, int d, int D>
struct WaterShare {
  std::array<BatchLanes, D> turning;      ///< see turning_of; affine transfer only
  std::array<Lanes<8>, 8> along, turned;  ///< see water_along, weights_of_momentum
  std::array<BatchLanes, CellWindow<D>::kFaces / 4> weight{},
      across{};  ///< by rows; kg·m/s, by the arms across

  template <class Kernel>
  QUICKSAND_INLINE WaterShare(const State<D>& s, const Kernel& kernel, const PointBatch<D>& batch,
                              const BatchLanes& mass, const BatchLanes& v)
      : turning(turning_if<S, d>(s, batch, mass)),
        along(water_along<S>(kernel.face[d], mass, mass * v, turning[0])),
        turned(S::affine ? weights_of_momentum(kernel.face[d]) : along) {
    const auto& other = kernel.center[axis_of(d, 1)];
    const auto& last = kernel.center[axis_of(d, D - 1)];
    for (int z = 0; z < CellWindow<D>::kLast; ++z)
      for (int y = 0; y < 3; ++y) {
        const int r = y + 3 * z;
        weight[r] = D == 2 ? other.w[y] : other.w[y] * last.w[z];
        if constexpr (S::affine) {
          across[r] = turning[1] * other.arm(y);
          if constexpr (D == 3) across[r] += turning[2] * last.arm(z);
          across[r] *= weight[r];
        }
      }
  }
  /// Σ of points `from` to `to` on their cell's window.
  QUICKSAND_INLINE WaterRows<D> rows(int from, int to) const {
    WaterRows<D> sum{};
    for (std::size_t r = 0; r < sum.size(); ++r) {
      Lanes<8> row{};
      for (int k = from; k < to; ++k) {
        row += weight[r][k] * along[k];
        if constexpr (S::affine) row += across[r][k] * turned[k];
      }
      sum[r] = row;
    }
    return sum;
  }
};

/// Volumes of the points in the three cells of a row, [3] of it unused.
template <int D>
using VolumeRows = std::array<Lanes<4>, CellWindow<D>::kCenters / 3>;
template <int D, class Kernel>
QUICKSAND_INLINE VolumeRows<D> volume_rows(const Kernel& kernel, const std::array<Lanes<8>, 8>& along,
                                           int from, int to) {
  VolumeRows<D> sum{};
  for (int z = 0; z < CellWindow<D>::kLast; ++z)
    for (int y = 0; y < 3; ++y) {
      const BatchLanes w = D == 2 ? kernel.center[1].w[y] : kernel.center[1].w[y] * kernel.center[D - 1].w[z];
      Lanes<4> row{};
      for (int k = from; k < to; ++k) row += w[k] * __builtin_shufflevector(along[k], along[k], 0, 1, 2, 3);
      sum[y + 3 * z] = row;
    }
  return sum;
}

template <class S, int D>
void water_to_faces(State<D>& s, const PointBatch<D>& batch) {
  CellKernel<D, typename S::Shape> kernel;
  kernel.find(s.grid, batch.places(), batch.get(s.water.x));
  const BatchWindows<D> windows(s.grid, s.water_walls, batch);
  const BatchLanes mass = batch.only(batch.get(s.water.mass));
  const std::array<BatchLanes, D> v = batch.get(s.water.v);
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    const WaterShare<S, d, D> share(s, kernel, batch, mass, v[d]);
    windows.each(
        batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
          const WaterRows<D> rows = share.rows(from, to);
          window.faces(
              d, [&](int node, int face, double sign) __attribute__((always_inline)) {
                const Lanes<8>& row = rows[node / 4];
                const int x = 2 * (node % 4);
                add_lanes<2>(s.sums[d][face].water_mass, Lanes<2>{row[x], sign * row[x + 1]});
                if (sign < 0) s.image[d][face].water += 2 * row[x];
              });
        });
  });
  const auto& own = kernel.center[0];
  const BatchLanes volume = mass / s.constants.water_density, none{};
  const std::array<Lanes<8>, 8> along =
      transposed({own.w[0] * volume, own.w[1] * volume, own.w[2] * volume, none, none, none, none, none});
  windows.each(
      batch, [&](const auto& window, int from, int to) __attribute__((always_inline)) {
        const VolumeRows<D> volumes = volume_rows<D>(kernel, along, from, to);
        window.centers([&](int node, int cell) __attribute__((always_inline)) {
          s.cell_sums[cell].water += volumes[node / 3][node % 3];
        });
      });
}

}  // namespace quicksand

#pragma once
// Loops over the points of a block, whose kernels are worked out some at a time.

#include <type_traits>

#include "engine/grid/stencil.hpp"
#include "engine/points/blocks.hpp"

namespace quicksand {

template <int D>
using Places = std::type_identity_t<std::vector<Vec<D>>>;  ///< as an argument that D is not deduced from

/// Some points of one block with their kernels.
template <int D, class Shape>
struct PointBatch {
  int count = 0;
  std::array<std::uint32_t, KernelBatch<D, Shape>::size> point;
  KernelBatch<D, Shape> kernel;
};

/// f(batch) for the points of block b, in their order.
template <class Shape, int D, class F>
void for_batches(const Grid<D>& grid, const Places<D>& x, const BlockList& list, int b, F&& f) {
  using Batch = PointBatch<D, Shape>;
  constexpr std::uint32_t size = KernelBatch<D, Shape>::size;
  Batch batch;
  std::array<Lanes<size>, D> places{};
  const std::uint32_t end = list.begin[b + 1];
  for (std::uint32_t i = list.begin[b]; i < end; i += size) {
    batch.count = static_cast<int>(std::min(size, end - i));
    for (int k = 0; k < batch.count; ++k) {
      const std::uint32_t p = batch.point[k] = list.order[i + k];
      for (int d = 0; d < D; ++d) places[d][k] = x[p][d];
    }
    batch.kernel.find(grid, places);
    f(batch);
  }
}

/// f(point, its kernel) for the points of block b, in their order.
template <class Shape, int D, class F>
void for_points(const Grid<D>& grid, const Places<D>& x, const BlockList& list, int b, F&& f) {
  for_batches<Shape>(grid, x, list, b, [&](const PointBatch<D, Shape>& batch) {
    for (int k = 0; k < batch.count; ++k) f(batch.point[k], batch.kernel[k]);
  });
}

}  // namespace quicksand

#include "engine/grid/walls.hpp"

#include <map>

namespace quicksand {
namespace {

/// Per axis and face: 0 passes; these mirror, the second changing the sign of tangential components too.
constexpr std::uint8_t kMirror = 1, kNoSlipMirror = 2, kCarriedMirror = 3;
template <int D>
using Mirrors = std::array<Field<std::uint8_t>, D>;

/// A walk of at most one cell along each axis from a home cell, mirrored back at closed faces.
template <int D>
struct Walk {
  int cell = 0;
  std::array<bool, D> mirrored{};
  std::array<int, D> wall{};  ///< face that mirrored, per axis
  std::array<bool, D> no_slip{};
  bool direct() const {
    for (bool m : mirrored)
      if (m) return false;
    return true;
  }
};

template <int D>
Walk<D> walk(const Grid<D>& grid, const Mirrors<D>& mirrors, int home, const std::array<int, D>& offset,
             const std::array<int, D>& order) {
  Walk<D> w;
  w.cell = home;
  w.wall.fill(-1);
  for (int axis : order) {
    if (offset[axis] == 0) continue;
    const int face = offset[axis] > 0 ? w.cell + grid.stride[axis] : w.cell;
    if (mirrors[axis][face]) {
      w.mirrored[axis] = true;
      w.wall[axis] = face;
      w.no_slip[axis] = mirrors[axis][face] == kNoSlipMirror;
    } else {
      w.cell += offset[axis] * grid.stride[axis];
    }
  }
  return w;
}

/// Direct if any order of the axes reaches the cell without a wall; otherwise the order that crosses
/// `first` before the others, so that a component is mirrored tangentially at convex corners.
template <int D>
Walk<D> best_walk(const Grid<D>& grid, const Mirrors<D>& mirrors, int home, const std::array<int, D>& offset,
                  int first) {
  std::array<int, D> order;
  order[0] = first;
  for (int d = 0, k = 1; d < D; ++d)
    if (d != first) order[k++] = d;
  const Walk<D> preferred = walk<D>(grid, mirrors, home, offset, order);
  if (preferred.direct()) return preferred;
  std::sort(order.begin(), order.end());
  do {
    const Walk<D> other = walk<D>(grid, mirrors, home, offset, order);
    if (other.direct()) return other;
  } while (std::next_permutation(order.begin(), order.end()));
  return preferred;
}

/// Where a cell centre's weight goes. At a convex corner the ways round it disagree; the home cell then keeps
/// the weight, because it is also the one that misses the weight of the points that the corner replaces: a
/// uniform filling stays uniform.
template <int D>
int fold_center(const Grid<D>& grid, const Mirrors<D>& mirrors, int home, const std::array<int, D>& offset) {
  std::array<int, D> order;
  for (int d = 0; d < D; ++d) order[d] = d;
  int landed = -1;
  bool agree = true;
  do {
    const Walk<D> w = walk<D>(grid, mirrors, home, offset, order);
    if (w.direct()) return w.cell;
    agree = agree && (landed < 0 || landed == w.cell);
    landed = w.cell;
  } while (std::next_permutation(order.begin(), order.end()));
  return agree ? landed : home;
}

/// Whether any walk from a cell meets a mirror.
template <int D>
bool mirror_in_reach(const Grid<D>& grid, const Mirrors<D>& mirrors, int home) {
  constexpr int around = D == 2 ? 3 : 9;
  for (int d = 0; d < D; ++d)
    for (int k = 0; k < around; ++k) {
      int face = home;
      for (int a = 0, rest = k; a < D; ++a)
        if (a != d) face += (rest % 3 - 1) * grid.stride[a], rest /= 3;
      if (mirrors[d][face] || mirrors[d][face + grid.stride[d]]) return true;
    }
  return false;
}

/// (component, inner face, mirror) → number of the ghost.
using GhostIndex = std::map<std::array<int, 3>, std::size_t>;

}  // namespace

template <int D>
Walls<D>::Walls(const Grid<D>& grid) : blocked_(grid.count(), 1), fold_of_(grid.count()) {
  for (auto* flags : {&closed_, &separated_, &separated_next_, &port_, &carried_})
    for (auto& of_face : *flags) of_face = Field<std::uint8_t>(grid.count());
  for_each_cell(grid, [&](int i, const Cell<D>&) { blocked_[i] = 0; });
}

template <int D>
void Walls<D>::rebuild(const Grid<D>& grid) {
  folds_.clear();
  fold_of_ = Field<std::int32_t>(grid.count());
  Mirrors<D> mirrors = port_;
  for (int d = 0; d < D; ++d)
    for (std::size_t i = 0; i < closed_[d].size(); ++i)
      if (closed_[d][i])
        mirrors[d][i] = closed_[d][i] == kNoSlip ? kNoSlipMirror : kMirror;
      else if (carried_[d][i])
        mirrors[d][i] = kCarriedMirror;
  GhostIndex index;
  for (auto& ghosts : ghosts_) ghosts.clear();
  for_each_cell(grid, [&](int home, const Cell<D>&) {
    if (!mirror_in_reach<D>(grid, mirrors, home)) return;
    CellFolds f;
    bool plain = true;
    for (int d = 0; d < D; ++d)
      for (int k = 0; k < kFaces; ++k) {
        // k counts position along d (0…3 ↔ −1…2) fastest, then −1…1 along the other axes.
        std::array<int, D> offset{};
        int rest = k;
        const int q = rest % 4 - 1;
        rest /= 4;
        offset[d] = q < 0 ? -1 : q > 1 ? 1 : 0;
        for (int a = 0; a < D; ++a)
          if (a != d) offset[a] = rest % 3 - 1, rest /= 3;
        const Walk<D> w = best_walk<D>(grid, mirrors, home, offset, d);
        int position = q == 2 || q == 1 ? 1 : 0;  // which side of the reached cell the face is on
        Fold& fold = f.face[d][k];
        if (w.mirrored[d]) {
          position = 1 - position;
          fold.normal_wall = w.wall[d];
        }
        fold.target = w.cell + position * grid.stride[d];
        for (int a = 0; a < D; ++a)
          if (a != d && w.mirrored[a] && w.no_slip[a]) fold.tangential = -fold.tangential;
        if (w.mirrored[d] && mirrors[d][w.wall[d]] == kCarriedMirror) {
          const auto [at, is_new] = index.try_emplace({d, fold.target, w.wall[d]}, ghosts_[d].size());
          if (is_new) ghosts_[d].push_back({fold.target, w.wall[d]});
          fold.target = grid.count() + static_cast<int>(at->second);
          fold.normal_wall = -1;
        }
        plain = plain && w.direct();
      }
    for (int k = 0; k < kCells; ++k) {
      std::array<int, D> offset{};
      for (int a = 0, rest = k; a < D; ++a, rest /= 3) offset[a] = rest % 3 - 1;
      f.center[k] = fold_center<D>(grid, mirrors, home, offset);
    }
    if (plain) return;
    folds_.push_back(f);
    fold_of_[home] = static_cast<std::int32_t>(folds_.size());
  });
}

template class Walls<2>;
template class Walls<3>;

}  // namespace quicksand

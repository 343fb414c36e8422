#pragma once
// Where one phase cannot pass: closed faces, and how kernels fold at them.
//
// A wall is a mirror plane. What a kernel would put on a face behind a wall goes to the mirror image of
// that face on the point's own side: masses as they are, normal components with the sign changed,
// tangential ones as they are (slip) or with the sign changed (no slip). Walls of no thickness and
// blocks are treated alike, because visibility is asked cell by cell, from the point's own cell outwards.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/grid/grid.hpp"

namespace quicksand {

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// What becomes of a face (or cell centre) near a wall.
struct Fold {
  int target = 0;        ///< face or cell index that receives it
  float tangential = 1;  ///< sign from mirrors across other axes
  int normal_wall = -1;  ///< wall face of the mirror across the component's own axis; −1: none
};

template <int D>
class Walls {
 public:
  static constexpr int kFaces = 4 * power(3, D - 1);  ///< faces of one component around a cell
  static constexpr int kCells = power(3, D);
  struct CellFolds {
    std::array<std::array<Fold, kFaces>, D> face;  ///< [d][k], k: position −1…2 along d, −1…1 along others
    std::array<int, kCells> center;                ///< cell index
  };

  Walls() = default;
  explicit Walls(const Grid<D>& grid);

  bool closed(int d, int face) const { return closed_[d][face] != 0; }
  bool no_slip(int d, int face) const { return closed_[d][face] == 2; }
  /// A face closed twice is no-slip if either is.
  void close(int d, int face, bool no_slip) {
    closed_[d][face] = std::max<std::uint8_t>(closed_[d][face], no_slip ? 2 : 1);
  }
  void open(int d, int face) { closed_[d][face] = 0; }
  /// A cell that the phase can never enter (block, outside of the domain).
  bool blocked(int cell) const { return blocked_[cell] != 0; }
  void block(int cell) { blocked_[cell] = 1; }

  /// True where matter is leaving a closed face on its own (grains lifting off a floor): the mirror then
  /// keeps the sign of the normal component, and the face itself moves. Set by the step, for grains only.
  bool separated(int d, int face) const { return separated_[d][face] != 0; }
  void set_separated(int d, int face, bool value) { separated_next_[d][face] = value; }
  /// Makes what was set hold from here on: between two steps, so that one step folds with one sign.
  void commit_separated() { separated_ = separated_next_; }

  /// Recomputes the folds; call after the last close/open.
  void rebuild(const Grid<D>& grid);
  /// Folds of a cell, or null where no wall is in reach.
  const CellFolds* folds(int cell) const { return fold_of_[cell] < 0 ? nullptr : &folds_[fold_of_[cell]]; }

 private:
  std::array<std::vector<std::uint8_t>, D> closed_;  ///< 0 open, 1 slip, 2 no slip
  std::array<std::vector<std::uint8_t>, D> separated_, separated_next_;
  std::vector<std::uint8_t> blocked_;
  std::vector<std::int32_t> fold_of_;
  std::vector<CellFolds> folds_;
};

extern template class Walls<2>;
extern template class Walls<3>;

}  // namespace quicksand

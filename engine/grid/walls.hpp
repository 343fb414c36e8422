#pragma once
// Where one phase cannot pass: closed faces, and how kernels fold at them.
//
// A wall is a mirror plane. What a kernel would put on a face behind a wall goes to the mirror image of
// that face on the point's own side: masses as they are, normal components with the sign changed,
// tangential ones as they are (slip) or with the sign changed (no slip). Walls of no thickness and
// blocks are treated alike, because visibility is asked cell by cell, from the point's own cell outwards.
// A port is a face of the boundary that can be open: it mirrors too, but keeps the sign of the normal
// component while it is open, so that what flows through it continues unchanged beyond.
// A carried face moves with a velocity of its own (a plate) and is not closed. It mirrors on both sides,
// relative to that velocity, which kernels do not know: normal components behind it are kept apart, on
// ghosts.

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/grid/field.hpp"
#include "engine/grid/grid.hpp"

namespace quicksand {

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// What becomes of a face (or cell centre) near a wall.
struct Fold {
  int target = 0;        ///< face or cell index that receives it
  float tangential = 1;  ///< sign from mirrors across other axes
  int normal_wall = -1;  ///< wall face of the mirror across the component's own axis; −1: none
};

/// Stands for the faces behind a carried face, seen from one side.
struct Ghost {
  int inner = 0;    ///< face whose mirror image it is
  int carried = 0;  ///< the mirror
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
  bool no_slip(int d, int face) const { return closed_[d][face] == kNoSlip; }
  /// A plane of symmetry: the normal velocity is zero both ways.
  bool symmetry(int d, int face) const { return closed_[d][face] == kSymmetry; }
  /// A face closed twice is no-slip if either is.
  void close(int d, int face, bool no_slip) {
    closed_[d][face] = std::max(closed_[d][face], no_slip ? kNoSlip : kSlip);
  }
  void close_as_symmetry(int d, int face) { closed_[d][face] = kSymmetry; }

  void open(int d, int face) { closed_[d][face] = kOpen; }

  bool carried(int d, int face) const { return carried_[d][face] != 0; }
  void carry(int d, int face) { carried_[d][face] = 1; }
  void carry_none() {
    for (auto& c : carried_) std::fill(c.begin(), c.end(), std::uint8_t{0});
  }
  /// Ghosts of component d: number k has the index grid.count() + k where faces are asked for. Known after
  /// `rebuild`.
  const std::vector<Ghost>& ghosts(int d) const { return ghosts_[d]; }

  bool port(int d, int face) const { return port_[d][face] != 0; }
  /// Makes a face of the boundary a port, open at first.
  void make_port(int d, int face) {
    port_[d][face] = 1;
    set_port_open(d, face, true);
  }
  void set_port_open(int d, int face, bool open) {
    closed_[d][face] = open ? kOpen : kSlip;
    separated_[d][face] = separated_next_[d][face] = open;
  }
  /// A cell that the phase can never enter (block, outside of the domain).
  bool blocked(int cell) const { return blocked_[cell] != 0; }
  void block(int cell) { blocked_[cell] = 1; }

  /// True where matter is leaving a closed face on its own (grains lifting off a floor): the mirror then
  /// keeps the sign of the normal component, and the face itself moves. Set by the step, for grains only.
  bool separated(int d, int face) const { return separated_[d][face] != 0; }
  void set_separated(int d, int face, bool value) { separated_next_[d][face] = value; }
  /// Makes what was set hold from here on: between two steps, so that one step folds with one sign.
  void commit_separated(int d, int face) { separated_[d][face] = separated_next_[d][face]; }
  /// Both of a face: what holds, and what will.
  std::uint8_t separation(int d, int face) const {
    return static_cast<std::uint8_t>(separated_[d][face] + 2 * separated_next_[d][face]);
  }
  void set_separation(int d, int face, std::uint8_t both) {
    separated_[d][face] = both & 1;
    separated_next_[d][face] = both >> 1;
  }

  /// Recomputes the folds; call after the last close/open.
  void rebuild(const Grid<D>& grid);
  /// Gives their memory back, where nobody will ask for them: all cells are as if no wall were in reach.
  void drop_folds() {
    folds_ = {};
    fold_of_ = Field<std::int32_t>(fold_of_.size());
  }
  /// What goes with momenta, forces and velocities of component d when they are mirrored.
  double sign(int d, const Fold& fold) const {
    const bool turned = fold.normal_wall >= 0 && !separated(d, fold.normal_wall);
    return turned ? -fold.tangential : fold.tangential;
  }
  /// Folds of a cell, or null where no wall is in reach.
  const CellFolds* folds(int cell) const {
    return fold_of_[cell] == 0 ? nullptr : &folds_[fold_of_[cell] - 1];
  }

 private:
  static constexpr std::uint8_t kOpen = 0, kSlip = 1, kNoSlip = 2, kSymmetry = 3;
  std::array<Field<std::uint8_t>, D> closed_;  ///< one of the above per face
  std::array<Field<std::uint8_t>, D> separated_, separated_next_, port_, carried_;
  Field<std::uint8_t> blocked_;
  Field<std::int32_t> fold_of_;  ///< per cell, 1 + index into folds, or 0
  std::vector<CellFolds> folds_;
  std::array<std::vector<Ghost>, D> ghosts_;
};

extern template class Walls<2>;
extern template class Walls<3>;

}  // namespace quicksand

#pragma once
// One-dimensional factors of all weights of one point. Loops over all points take them cell by cell
// (cell_kernel.hpp); this is for the few, and what those loops are tested against.

#include <algorithm>

#include "engine/grid/grid.hpp"
#include "engine/grid/kernel.hpp"

namespace quicksand {

template <int D, class S = QuadraticSpline>
class PointKernel {
 public:
  using Shape = S;
  PointKernel(const Grid<D>& grid, const Vec<D>& x) {
    const Cell<D> c = grid.cell_of(x);
    home_ = grid.index(c);
    for (int d = 0; d < D; ++d) {
      const double xi = clamped((x[d] - grid.origin[d]) * grid.inverse_h - c[d], 0.0, 1.0);
      center_[d] = S::on_centers(xi);
      face_[d] = S::on_faces(xi);
    }
  }
  int home() const { return home_; }  ///< index of the point's cell
  const Nodes<S::faces>& face(int a) const { return face_[a]; }
  const Nodes<S::centers>& center(int a) const { return center_[a]; }

 private:
  int home_ = 0;
  std::array<Nodes<S::centers, double>, D> center_;
  std::array<Nodes<S::faces, double>, D> face_;
};

}  // namespace quicksand

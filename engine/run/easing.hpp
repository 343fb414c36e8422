#pragma once
#include <cmath>

#include "engine/plan/plan.hpp"

namespace quicksand {

/// Shorter steps after one that failed. Every failure halves them; they stay so until two good states in a
/// row were reached without another one, then double with every further one. A function of the steps alone,
/// so that it is the same on any number of threads and in a run that was resumed.
class Easing {
 public:
  /// –, of the step that bounds allow.
  double factor() const { return std::ldexp(1.0, -halvings_); }
  StepBound shortened(StepBound bound) const {
    if (halvings_ > 0) bound = {"retry", bound.seconds * factor()};
    return bound;
  }
  /// After a failure. False when steps have been halved as often as they may be.
  bool shorten(int most) {
    if (halvings_ >= most) return false;
    ++halvings_;
    failed_ = true;
    return true;
  }
  /// A good state was reached.
  void came_through() {
    if (!failed_ && halvings_ > 0) --halvings_;
    failed_ = false;
  }
  template <class A>
  void keep(A& a) {
    a(halvings_, failed_);
  }

 private:
  int halvings_ = 0;
  bool failed_ = false;  ///< since the last good state
};

}  // namespace quicksand

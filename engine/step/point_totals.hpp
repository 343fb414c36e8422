#pragma once
// What a step counts over all points while it moves them.

#include <limits>

#include "engine/step/batches.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// Of one block; summed over blocks in their order.
template <int D>
struct Totals {
  Vec<D> momentum{};
  Vec<D> let_go{};  ///< N·s, what the surface did not give to drops that fall freely
  double mass = 0, kinetic = 0, max_speed2 = 0, max_soil_speed2 = 0;
  double soil_limit = std::numeric_limits<double>::infinity();       ///< s
  double fast_wave_limit = std::numeric_limits<double>::infinity();  ///< s
  Interventions interventions;
  bool finite = true;
  Totals& operator+=(const Totals& o) {
    for (int d = 0; d < D; ++d) momentum[d] += o.momentum[d], let_go[d] += o.let_go[d];
    mass += o.mass;
    kinetic += o.kinetic;
    max_speed2 = std::max(max_speed2, o.max_speed2);
    max_soil_speed2 = std::max(max_soil_speed2, o.max_soil_speed2);
    soil_limit = std::min(soil_limit, o.soil_limit);
    fast_wave_limit = std::min(fast_wave_limit, o.fast_wave_limit);
    interventions += o.interventions;
    finite = finite && o.finite;
    return *this;
  }
};

/// Mass and motion of the points of one phase in a block, lane by lane.
template <int D>
class MotionTotals {
 public:
  /// Of a batch; `also` is any number that must be finite too.
  QUICKSAND_INLINE void add(const PointBatch<D>& batch, const std::vector<double>& mass,
                            const std::array<BatchLanes, D>& v, const BatchLanes& also) {
    const BatchLanes m = batch.only(batch.get(mass));
    BatchLanes speed2{};
    for (int d = 0; d < D; ++d) {
      const BatchLanes component = batch.only(v[d]);
      momentum_[d] += m * component;
      speed2 += component * component;
    }
    mass_ += m;
    kinetic_ += 0.5 * m * speed2;
    max_speed2_ = where(speed2 > max_speed2_, speed2, max_speed2_);
    finite_ += 0.0 * (speed2 + batch.only(also));  // not a number is never lost
  }
  void add_to(Totals<D>& totals) const {
    for (int k = 0; k < kBatch; ++k) {
      for (int d = 0; d < D; ++d) totals.momentum[d] += momentum_[d][k];
      totals.mass += mass_[k];
      totals.kinetic += kinetic_[k];
      totals.max_speed2 = std::max(totals.max_speed2, max_speed2_[k]);
      totals.finite = totals.finite && finite_[k] == 0;
    }
  }

 private:
  std::array<BatchLanes, D> momentum_{};
  BatchLanes mass_{}, kinetic_{}, max_speed2_{}, finite_{};
};

/// Porosities of the soil points in a block, lane by lane: of those next to air and of the others.
class PorosityRanges {
 public:
  /// `confined`: 1 for points that are, else 0.
  template <int D>
  QUICKSAND_INLINE void add(const PointBatch<D>& batch, const BatchLanes& n, const BatchLanes& confined) {
    const BatchLanes there = batch.only(all_lanes<BatchLanes>(1));
    dry_.add(n, there * (1.0 - confined) > 0.5);
    saturated_.add(n, there * confined > 0.5);
  }
  /// Next to the air no pressure resists, so that the frame's own wave is the bound.
  template <int D>
  void add_to(Totals<D>& totals, const StepLimit& limit, bool explicit_pressure) const {
    const StepLimit::Range dry = dry_.range(), saturated = saturated_.range();
    totals.soil_limit = std::min({totals.soil_limit, limit.least_dry(dry), limit.least_saturated(saturated)});
    if (!explicit_pressure) return;
    totals.fast_wave_limit =
        std::min({totals.fast_wave_limit, limit.least_fast_wave(dry), limit.least_fast_wave(saturated)});
  }

 private:
  struct Extremes {
    BatchLanes low = all_lanes<BatchLanes>(2), high = all_lanes<BatchLanes>(-1);
    template <class Mask>
    QUICKSAND_INLINE void add(const BatchLanes& n, const Mask& of) {
      low = where(of & (n < low), n, low);
      high = where(of & (n > high), n, high);
    }
    StepLimit::Range range() const {
      StepLimit::Range all;
      for (int k = 0; k < kBatch; ++k)
        all.low = std::min(all.low, low[k]), all.high = std::max(all.high, high[k]);
      return all;
    }
  };
  Extremes dry_, saturated_;
};

}  // namespace quicksand

#pragma once
// Time histories of a run: probes, bodies, the ledger; and the headline figures of a heave.

#include "engine/run/run.hpp"
#include "engine/run/stage.hpp"
#include "engine/step/step.hpp"

namespace quicksand {

/// Keeps what is conserved and what was done to the state.
template <int D>
class LedgerKeeper {
 public:
  LedgerKeeper(const Scene& scene, const State<D>& start);
  /// After every step.
  void add(const State<D>& state, const StepReport<D>& step);
  /// At the start of every stage.
  void add(const StageChange<D>& change);
  /// Volumes, masses, energies; before each sample.
  void measure(const State<D>& state, const StepReport<D>& step);
  /// What was measured last is a sample.
  void sampled();
  const Ledger& ledger() const { return ledger_; }
  template <class A>
  void keep(A& a) {
    a(ledger_, start_momentum_, driving_impulse_, drift_, drifts_, drift_sum_);
  }

 private:
  double potential(const State<D>& state) const;
  Ledger ledger_;
  Vec<D> start_momentum_{};
  double driving_impulse_ = 0;  ///< N·s, of weight and loads, and the momentum at the start
  double drift_ = 0;            ///< –, of the water's volume, measured last
  std::vector<double> drifts_;  ///< –, of the water's volume, every sample
  double drift_sum_ = 0;        ///< –, of the second half of them
};

/// How far a body has moved; once it is removed or has left, how far it had.
struct BodyRise {
  double mean = 0, largest = 0;  ///< m: mean upward, by mass, largest |displacement|
};

/// Samples all series of a scene; `info` and `sample` agree in order.
template <int D>
class Watch {
 public:
  explicit Watch(const Scene& scene);
  std::vector<SeriesInfo> info() const;
  std::vector<double> sample(const State<D>& state, const StepReport<D>& step, const Ledger& ledger);
  /// After every step: keeps the largest head difference until the watched body has moved.
  void track(const State<D>& state);
  const std::vector<HeaveReport>& heave() const { return heave_; }
  template <class A>
  void keep(A& a) {
    a(rise_, heave_);
  }

 private:
  void sample_rise(double time);
  double head_of(const State<D>& state, const std::string& probe) const;
  const Scene& scene_;
  std::vector<int> moving_soil_;  ///< bodies
  std::vector<BodyRise> rise_;    ///< of these
  std::vector<HeaveReport> heave_;
  bool ports_ = false;         ///< water can enter or leave
  bool quasi_static_ = false;  ///< some stage is
  bool damps_ = false;         ///< some stage does
  bool removes_ = false;       ///< some stage takes bodies away
  double probe_distance_ = 0;  ///< m, along gravity, between the probes of the heave watch
};

}  // namespace quicksand

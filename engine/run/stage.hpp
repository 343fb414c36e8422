#pragma once
// The beginning of a stage: what it changes in the state, and how its inertia is watched.

#include <algorithm>
#include <limits>

#include "engine/plan/quasi_static.hpp"
#include "engine/run/removal.hpp"
#include "engine/run/run.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/step.hpp"

namespace quicksand {

/// What the beginning of a stage did to the state other than by the equations.
template <int D>
struct StageChange {
  Vec<D> impulse{};    ///< N·s, change of momentum by scaled inertia
  Removed<D> removed;  ///< with bodies
};

/// Bodies (`remove_bodies`), boundaries (`enter_stage`) and inertia of stage `index`. Where inertia grows,
/// velocities fall so that momentum stays: motion left over from before would else carry energy that nothing
/// put in. Where it falls back, velocities stay, as a slow process goes on at its pace; the momentum that is
/// lost is the change's impulse.
template <int D>
StageChange<D> begin_stage(const Scene& scene, std::size_t index, State<D>& state);

/// What the ratio of energies is at most, so that it stays a number where nothing is strained.
constexpr double kLargestInertiaRatio = 1e9;

/// Kinetic over strain energy; 0 while there is neither.
inline double inertia_ratio(double kinetic, double strain) {
  return kinetic > 0 ? kinetic / std::max(strain, kinetic / kLargestInertiaRatio) : 0;
}

/// Watches kinetic against strain energy in quasi-static stages.
class InertiaWatch {
 public:
  void begin(const Scene& scene, std::size_t stage, double time);
  template <int D>
  void add(const State<D>& s, const StepReport<D>& step) {
    if (!active_ || s.time < settled_) return;
    QuasiStaticReport& r = reports_.back();
    r.inertia_ratio = std::max(r.inertia_ratio, quicksand::inertia_ratio(step.kinetic, strain_energy(s)));
    r.negligible = r.inertia_ratio <= kNegligibleInertia;
  }
  const std::vector<QuasiStaticReport>& reports() const { return reports_; }
  template <class A>
  void keep(A& a) {
    a(reports_, active_, settled_);
  }

 private:
  std::vector<QuasiStaticReport> reports_;
  bool active_ = false;
  double settled_ = 0;  ///< s, from when on energies count
};

}  // namespace quicksand

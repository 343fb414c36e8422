#pragma once
// A scene in motion, advanced by the steps that a run would take.

#include <array>
#include <map>
#include <memory>
#include <string>

#include "engine/plan/step_bounds.hpp"
#include "engine/run/frame.hpp"
#include "engine/run/good_state.hpp"
#include "engine/run/setup.hpp"
#include "engine/run/snapshot.hpp"
#include "engine/step/step.hpp"
#include "tests/bench/allocated.hpp"
#include "tests/bench/memory.hpp"

namespace quicksand::bench {

using PhaseSeconds = std::array<double, kPhaseNames.size()>;

class Workload {
 public:
  virtual ~Workload() = default;
  virtual PressureReport step() = 0;
  /// Makes a frame of all fields, as a run does at its end, and drops it.
  virtual void last_frame() const = 0;
  virtual double points() const = 0;
  virtual const PhaseSeconds& phase_seconds() const = 0;
  virtual Allocated allocated() const = 0;

  /// What came to be resident with the state and its first steps, bytes.
  double resident = 0;
  /// Of the state that is kept to go back to, bytes; 0 if none is.
  double good_bytes = 0;
};

template <int D>
class WorkloadIn final : public Workload {
 public:
  WorkloadIn(const Scene& scene, bool as_run) : scene_(scene), state_(make_state<D>(scene)) {
    Frame frame;
    if (as_run) frame = make_frame(scene_, state_, 0, "");
    last_ = advance(state_, kFirstStep);
    if (as_run) keep_good();
  }

  PressureReport step() override {
    const StepSituation now{last_.soil_limit, last_.max_speed, state_.water.size() > 0, last_.fast_wave_limit,
                            state_.constants.inertia};
    last_ = advance(state_, choose_step(scene_, now).seconds);
    return last_.pressure;
  }
  void last_frame() const override { make_frame(scene_, state_, 1, ""); }
  double points() const override { return static_cast<double>(state_.soil.size() + state_.water.size()); }
  const PhaseSeconds& phase_seconds() const override { return state_.phase_seconds; }
  Allocated allocated() const override { return quicksand::bench::allocated(state_); }

 private:
  void keep_good() {
    good_.take(0, {}, [&](Saver& to) { save_state(to, state_); });
    good_bytes = static_cast<double>(good_.checkpoint().state.size());
  }

  /// s, only to have the soil's own limit of the next step measured.
  static constexpr double kFirstStep = 1e-7;

  Scene scene_;
  State<D> state_;
  StepReport<D> last_;
  RunOptions options_;
  GoodState good_{options_};
};

/// Steps before anything is measured: buffers have their sizes, the pressure its history, and asks for as
/// many iterations as in the steps that follow.
inline constexpr int kWarmUpSteps = 24;

/// Whether dry scenes and those of water alone have instantiations of their own of the loops over faces
/// (engine/step/scheme.hpp); `advance` chooses.
inline constexpr bool kReducedSteps = true;

/// A scene after its first step. As in any run, if `as_run`: a frame of all fields is made before it and held
/// back until the state after it is kept, to go back to when a later step fails.
inline std::unique_ptr<Workload> start(const Scene& scene, bool as_run = false) {
  if (scene.domain.dimension == Dimension::space) return std::make_unique<WorkloadIn<3>>(scene, as_run);
  return std::make_unique<WorkloadIn<2>>(scene, as_run);
}

/// A scene after some steps, with the memory that they took.
inline std::unique_ptr<Workload> warm_up(const Scene& scene, int steps = kWarmUpSteps) {
  const double before = resident_bytes();
  auto work = start(scene);
  resident_bytes();  // gives back what seeding left
  forget_peak();
  for (int i = 0; i < steps; ++i) work->step();
  work->resident = peak_bytes() - before;
  return work;
}

/// The workload of a name, kept for later repetitions and thread counts until another group asks.
template <class MakeScene>
Workload& kept_workload(const std::string& group, const std::string& name, MakeScene&& make_scene) {
  static std::string of;
  static std::map<std::string, std::unique_ptr<Workload>> kept;
  if (of != group) kept.clear();
  of = group;
  auto& work = kept[name];
  if (!work) work = warm_up(make_scene());
  return *work;
}

}  // namespace quicksand::bench

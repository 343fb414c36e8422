#pragma once
// Watches what no right answer can do: more energy than was put in, pressures that nothing can cause, water
// that gains or loses room. The first two fail a step; the last is told with the answer.

#include <optional>
#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "engine/step/step.hpp"

namespace quicksand {

/// A figure beyond what can be, in the scene's units.
struct Unsound {
  enum class Kind { energy, pressure } kind = Kind::energy;
  double figure = 0, bound = 0;  ///< J or Pa
};

template <int D>
class Soundness {
 public:
  Soundness(const Scene& scene, const State<D>& start, const StepReport<D>& motion);
  /// After every step, from the figures that it brought along; strain and
  /// pressures are looked at every few steps and before a sample (`look`).
  std::optional<Unsound> add(const State<D>& state, const StepReport<D>& step, const Ledger& ledger,
                             bool look);
  void sampled(const State<D>& state);
  /// What the answer has to be told with, in plain words.
  std::vector<std::string> cautions(const Ledger& ledger) const;
  template <class A>
  void keep(A& a) {
    a(energy_at_start_, moving_mass_, force_, driven_work_, water_in_, fastest_, shortest_step_, inertia_);
    a(pressures_, samples_, steps_);
  }

 private:
  double put_in() const;
  double largest_pressure() const;
  const Scene& scene_;
  double diagonal_ = 0, highest_head_ = 0;               ///< m
  double dense_ = 0, given_pressure_ = 0, storage_ = 0;  ///< kg/m³, Pa, Pa: Kw over the least porosity
  double given_energy_ = 0;                              ///< J, of the pressure at the start
  double energy_at_start_ = 0, moving_mass_ = 0;         ///< J, kg
  double force_ = 0, driven_work_ = 0, water_in_ = 0;    ///< N (largest), J (of driven plates), kg
  double fastest_ = 0, shortest_step_ = 0, inertia_ = 1;
  double pressures_ = 0;  ///< Pa, sum over the samples of the largest
  long samples_ = 0, steps_ = 0;
};

/// Mean of `Ledger::water_volume_drift` that is told: 1 % of what water and the grains among it fill (kernels
/// measure both together), and what the water's own compressibility adds at `pressure` Pa.
double allowed_drift(const Scene& scene, const Ledger& ledger, double pressure);

}  // namespace quicksand

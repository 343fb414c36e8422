#pragma once
#include <limits>

#include "engine/step/pressure.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// What a step reports besides the new state.
template <int D>
struct StepReport {
  PressureReport pressure;
  double max_speed = 0;                                        ///< m/s, of any point
  double max_soil_speed = 0;                                   ///< m/s
  Vec<D> momentum{};                                           ///< N·s, Σ m v of all points after the step
  double moving_mass = 0;                                      ///< kg, of all points that move
  Vec<D> impulse_walls{}, impulse_surface{}, impulse_loads{};  ///< N·s in this step
  Vec<D> impulse_damping{};                                    ///< N·s in this step
  double damped = 0;                                           ///< J, taken by damping in this step
  Exchange<D> exchange;                                        ///< through ports, in this step
  double kinetic = 0;                                          ///< J
  double soil_limit = 0;  ///< s, smallest stable step of any soil point; infinite without
  /// s, smallest StepLimit::fast_wave of any soil point; infinite unless the pressure is explicit
  double fast_wave_limit = std::numeric_limits<double>::infinity();
  double dt = 0;  ///< s, of the step that was taken
  bool finite = true;
};

/// One time step of dt seconds: points → faces → pressure → faces → points. A step whose velocities would
/// carry anything further than `kMaxTravel` cells is begun again with half the time (`cut_steps`).
inline constexpr double kMaxTravel = 0.7;
template <int D>
StepReport<D> advance(State<D>& state, double dt);

extern template StepReport<2> advance<2>(State<2>&, double);
extern template StepReport<3> advance<3>(State<3>&, double);

}  // namespace quicksand

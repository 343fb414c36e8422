#include "engine/step/step.hpp"

#include <chrono>
#include <cmath>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Not a number counts as staying: it is diagnosed by the run, not halved for ever.
template <int D>
bool travels_too_far(const State<D>& s, double dt) {
  const double limit = kMaxTravel * s.grid.h / dt;
  return s.blocks.template sum<long>([&](int b) {
    long far = 0;
    s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
      for (int d = 0; d < D; ++d) {
        const FaceFlow& f = s.flow[d][face];
        far += std::abs(f.soil) > limit || std::abs(f.water) > limit;
      }
    });
    return far;
  }) > 0;
}

/// Adds the wall time since the last lap to a phase.
class Stopwatch {
 public:
  explicit Stopwatch(std::array<double, kPhaseNames.size()>& seconds) : seconds_(seconds) {}
  void lap(Phase phase) {
    const auto now = std::chrono::steady_clock::now();
    seconds_[static_cast<std::size_t>(phase)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  std::array<double, kPhaseNames.size()>& seconds_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

template <int D>
StepReport<D> advance(State<D>& s, double dt) {
  StepReport<D> report;
  Stopwatch clock(s.phase_seconds);
  points_to_faces(s);  // 1. masses, momenta, forces on the faces
  clock.lap(Phase::to_grid);
  find_surface(s);  // 2. which cells have pressure, where it is zero
  clock.lap(Phase::surface);
  s.pressure_old = s.pressure;
  while (true) {
    predict_velocities(s, dt);  // 3. both momentum balances, drag inside
    clock.lap(Phase::velocities);
    report.pressure = solve_pressure(s, dt);  // 4. mass balance of the mixture
    clock.lap(Phase::pressure);
    correct_velocities(s);  // 5. velocities that keep it
    if (!travels_too_far(s, dt)) break;
    dt *= 0.5;
    s.pressure = s.pressure_old;
    ++s.interventions.cut_steps;
  }
  clock.lap(Phase::velocities);
  faces_to_points(s, dt, report);  // 6. strain, stress, porosity, positions
  clock.lap(Phase::to_points);
  s.time += dt;
  report.dt = dt;
  for (int d = 0; d < D; ++d) report.impulse_loads[d] = dt * s.load_force[d];
  return report;
}

template StepReport<2> advance<2>(State<2>&, double);
template StepReport<3> advance<3>(State<3>&, double);

}  // namespace quicksand

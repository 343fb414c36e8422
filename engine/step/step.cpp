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
    double fastest = 0;
    s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
      for (int d = 0; d < D; ++d) {
        const FaceSpeeds& v = s.speeds[d][face];
        fastest = std::max({fastest, std::abs(v.soil), std::abs(v.water)});
      }
    });
    return fastest > limit;
  }) > 0;
}

/// Halvings after which a step is given up: a state that needs a millionth of its stable step has run away.
constexpr int kMostCuts = 20;

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

/// The pressure of the last two steps' ends becomes that of their starts.
template <int D>
void keep_pressure(State<D>& s) {
  if (!s.has_water) return;
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
      s.pressure_before[i] = s.pressure_old[i];
      s.pressure_old[i] = s.pressure[i];
    });
  });
}

template <int D>
void restore_pressure(State<D>& s) {
  if (!s.has_water) return;
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) { s.pressure[i] = s.pressure_old[i]; });
  });
}

/// Velocities on the faces at the end of the step, and the pressure that goes with them. Returns the time
/// that the step may take; 0 if there is none.
template <int D>
double solve_velocities(State<D>& s, double dt, PressureReport& report, Stopwatch& clock) {
  keep_pressure(s);
  for (int cuts = 0; cuts <= kMostCuts; ++cuts, dt *= 0.5) {
    predict_velocities(s, dt);  // both momentum balances, drag inside
    press_plates(s, dt);        // what plates hold moves as one
    clock.lap(Phase::velocities);
    report = solve_pressure(s, dt);  // mass balance of the mixture
    clock.lap(Phase::pressure);
    settle_plates(s, dt);
    correct_velocities(s);  // velocities that keep it
    const bool fits = !travels_too_far(s, dt);
    clock.lap(Phase::velocities);
    if (fits) return dt;
    restore_pressure(s);
    ++s.interventions.cut_steps;
  }
  return 0;
}

}  // namespace

template <int D>
StepReport<D> advance(State<D>& s, double dt) {
  StepReport<D> report;
  Stopwatch clock(s.phase_seconds);
  sort_points(s);       // now and then
  set_ports(s);         // levels of reservoirs, seepage faces
  follow_discharge(s);  // speeds that the drag asks for
  points_to_faces(s);   // masses, momenta, forces on the faces
  clock.lap(Phase::to_grid);
  find_surface(s);  // which cells have pressure, where it is zero
  find_plain_blocks(s);
  clock.lap(Phase::surface);
  report.dt = solve_velocities(s, dt, report.pressure, clock);
  report.finite = report.dt > 0;
  if (!report.finite) return report;
  move_plates(s, report.dt);
  faces_to_points(s, report.dt, report);  // velocity, strain, stress, porosity, position
  pass_ports(s, report);                  // points that enter and leave
  clock.lap(Phase::to_points);
  s.time += report.dt;
  for (int d = 0; d < D; ++d) report.impulse_loads[d] = report.dt * s.load_force[d];
  return report;
}

template StepReport<2> advance<2>(State<2>&, double);
template StepReport<3> advance<3>(State<3>&, double);

}  // namespace quicksand

#include "engine/run/diagnosis.hpp"

#include <cmath>
#include <cstdio>

namespace quicksand {
namespace {

std::string number(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

/// The point that is worst: not finite, or else the fastest.
template <int D>
struct Suspect {
  bool found = false, soil = false;
  double badness = -1;
  Vec<D> x{};
  int body = 0;

  template <class Set>
  void look(const Set& set, bool is_soil) {
    for (std::size_t p = 0; p < set.size(); ++p) {
      double speed = 0;
      for (double c : set.v[p]) speed += c * c;
      const double bad = std::isfinite(speed) ? speed : std::numeric_limits<double>::infinity();
      if (bad <= badness) continue;
      *this = {true, is_soil, bad, set.x[p], set.body[p]};
    }
  }
};

template <int D>
Failure describe(const Scene& scene, const State<D>& s, const std::string& what, const std::string& remedy) {
  Suspect<D> worst;
  worst.look(s.soil, true);
  worst.look(s.water, false);
  Failure f{"diverged", what + " at t = " + number(s.time) + " s", s.time, {}};
  if (worst.found) {
    f.message += worst.soil ? ", first in soil" : ", first in water";
    f.message += worst.body >= 0 ? " of body '" + scene.bodies[worst.body].name + "'" : " that flowed in";
    f.message += " near (";
    for (int d = 0; d < D; ++d) {
      f.place[d] = worst.x[d];
      f.message += (d ? ", " : "") + number(worst.x[d]);
    }
    f.message += ") m";
    if (std::isfinite(worst.badness)) f.message += " moving at " + number(std::sqrt(worst.badness)) + " m/s";
  }
  f.message += ". " + remedy;
  return f;
}

std::string in_vain(double shortened) {
  return "Steps down to 1/" + number(1 / shortened) + " as long, from the last good state on, did not help";
}

std::string step_remedy(const Scene& scene, double shortened = 1) {
  if (shortened < 1)
    return in_vain(shortened) +
           ": the likely cause is not the time step but what acts there (a load, level, plate or gate), or a "
           "stiffness or strength that cannot bear it. Let it act more slowly (ramp), or change "
           "domain.cell_size.";
  if (scene.numerics.time_step)
    return "The fixed numerics.time_step of " + number(*scene.numerics.time_step) +
           " s is the likely cause: leave it out, so that stable steps are chosen.";
  return "The likely cause is a time step too near its bound: lower numerics.time_step_factor (now " +
         number(scene.numerics.time_step_factor) +
         ") by half; if that does not help, refine domain.cell_size.";
}

}  // namespace

template <int D>
Failure not_finite(const Scene& scene, const State<D>& s, double shortened) {
  return describe(scene, s,
                  "Velocities or stresses stopped being finite numbers, or no time step was short enough",
                  step_remedy(scene, shortened));
}

template <int D>
Failure collapsed_step(const Scene& scene, const State<D>& s, const StepBound& bound, double shortened) {
  return describe(scene, s,
                  "The time step that '" + bound.name + "' allows fell to " + number(bound.seconds) +
                      " s: motion ran away",
                  step_remedy(scene, shortened));
}

template <int D>
Failure pressure_not_found(const Scene& scene, const State<D>& s, double residual, double shortened) {
  return describe(
      scene, s, "The water pressure could not be solved for (relative residual " + number(residual) + ")",
      (shortened < 1 ? in_vain(shortened) + ". " : "") +
          "The likely cause is water torn into single drops, or numerics.pressure_tolerance (now " +
          number(scene.numerics.pressure_tolerance) +
          ") below what rounding allows: raise it to 1e-6 or refine domain.cell_size.");
}

template <int D>
Failure unstable_step(const Scene& scene, const State<D>& s, const StepBound& wave) {
  return describe(scene, s,
                  "A step of " + number(*scene.numerics.time_step) +
                      " s is above the stability bound of the " + wave.name + ", " + number(wave.seconds) +
                      " s,",
                  step_remedy(scene));
}

template <int D>
Failure unsound(const Scene& scene, const State<D>& s, const Unsound& what, double shortened) {
  if (what.kind == Unsound::Kind::energy)
    return describe(
        scene, s,
        "Motion and strain hold " + number(what.figure) + " J, more than the " + number(what.bound) +
            " J that can have been put in,",
        scene.numerics.pressure == PressureScheme::explicit_scheme
            ? "The likely cause is the explicit pressure, which cannot hold films and jets of a few "
              "cells: leave numerics.pressure out."
            : step_remedy(scene, shortened));
  const std::string rigid = scene.water.bulk_modulus ? "" : " water is incompressible here, and";
  return describe(
      scene, s,
      "The water pressure reached " + number(what.figure) + " Pa; weight, loads and motion can cause " +
          number(what.bound) + " Pa,",
      (shortened < 1 ? in_vain(shortened) + ". " : "") + "The likely cause is water without room:" + rigid +
          " something (a plate, a closing gate, a filling inflow) presses on it where it can "
          "neither leave nor rise. Let it out (a free surface, an open side, a reservoir), or give "
          "materials.water.bulk_modulus a number.");
}

template Failure unsound<2>(const Scene&, const State<2>&, const Unsound&, double);
template Failure unsound<3>(const Scene&, const State<3>&, const Unsound&, double);
template Failure unstable_step<2>(const Scene&, const State<2>&, const StepBound&);
template Failure unstable_step<3>(const Scene&, const State<3>&, const StepBound&);

Failure too_many_steps(const Scene& scene, double time) {
  return {"max_steps",
          "The run reached numerics.max_steps = " + std::to_string(scene.numerics.max_steps) +
              " at t = " + number(time) + " s. Raise it, shorten the stages or use a coarser preset.",
          time,
          {}};
}

template Failure not_finite<2>(const Scene&, const State<2>&, double);
template Failure not_finite<3>(const Scene&, const State<3>&, double);
template Failure collapsed_step<2>(const Scene&, const State<2>&, const StepBound&, double);
template Failure collapsed_step<3>(const Scene&, const State<3>&, const StepBound&, double);
template Failure pressure_not_found<2>(const Scene&, const State<2>&, double, double);
template Failure pressure_not_found<3>(const Scene&, const State<3>&, double, double);

}  // namespace quicksand

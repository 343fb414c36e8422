// Faces → points: velocities, strains and stress, porosity, positions.

#include <cmath>

#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"
#include "engine/step/soil_from_faces.hpp"
#include "engine/step/step.hpp"
#include "engine/step/water_from_faces.hpp"
#include "engine/threads/chunks.hpp"

namespace quicksand {
template <int D>
void faces_to_points(State<D>& s, double dt, StepReport<D>& report) {
  const double pic = s.constants.transfer == Transfer::apic ? 1 : 1 - std::exp(-s.constants.pic_rate * dt);
  const Supports<D> supports = support_impulses(s, dt, pic);
  report.impulse_walls = supports.walls;
  report.impulse_surface = supports.surface;
  report.impulse_damping = supports.damping;
  report.damped = supports.damped;
  const Totals<D> totals = with_scheme(s, [&](auto scheme) {
    using S = decltype(scheme);
    return s.blocks.template sum<Totals<D>>([&](int b) {
      Totals<D> t;
      MotionTotals<D> soil, water;
      PorosityRanges porosities;
      for_batches(s.blocks, s.soil_blocks, b, [&](const PointBatch<D>& batch) {
        soil_from_faces<S, D>(s, batch, dt, pic, t, soil, porosities);
      });
      soil.add_to(t);
      if (s.constants.one_stiffness())
        porosities.add_to(t, s.constants.step_limits.front(), s.constants.explicit_pressure);
      t.max_soil_speed2 = t.max_speed2;
      for_batches(s.blocks, s.water_blocks, b,
                  [&](const PointBatch<D>& batch) { water_from_faces<S, D>(s, batch, dt, pic, t, water); });
      water.add_to(t);
      return t;
    });
  });
  move_loads(s, dt);
  const double inertia = s.constants.inertia;
  for (int d = 0; d < D; ++d) {
    report.impulse_surface[d] += inertia * totals.let_go[d];
    s.momentum[d] = report.momentum[d] = inertia * totals.momentum[d];
  }
  report.moving_mass = totals.mass;
  report.kinetic = inertia * totals.kinetic;
  report.max_speed = std::sqrt(totals.max_speed2);
  report.max_soil_speed = std::sqrt(totals.max_soil_speed2);
  report.soil_limit = totals.soil_limit;
  report.fast_wave_limit = totals.fast_wave_limit;
  report.finite = totals.finite;
  s.interventions += totals.interventions;
}

template <int D>
void measure_motion(const State<D>& s, StepReport<D>& report) {
  report.momentum = s.momentum;
  const auto add = [&](const auto& set) {
    for (std::size_t p = 0; p < set.size(); ++p) {
      double speed2 = 0;
      for (double c : set.v[p]) speed2 += c * c;
      report.kinetic += 0.5 * s.constants.inertia * set.mass[p] * speed2;
      report.moving_mass += set.mass[p];
      report.max_speed = std::max(report.max_speed, std::sqrt(speed2));
    }
  };
  add(s.soil);
  report.max_soil_speed = report.max_speed;
  add(s.water);
}

template <int D>
double strain_energy(const State<D>& s) {
  return reduce_chunks(
      s.soil.size(), 0.0,
      [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t p = begin; p < end; ++p) {
          const SoilMaterial& material = s.constants.soils[s.soil.soil[p]];
          const double n = s.soil.porosity[p], volume = s.soil.mass[p] / (material.grain_density * (1 - n));
          sum += volume * material.energy<D>(soil_state(s.soil, p), n);
        }
        return sum;
      },
      [](double a, double b) { return a + b; });
}

template double strain_energy<2>(const State<2>&);
template double strain_energy<3>(const State<3>&);
template void measure_motion<2>(const State<2>&, StepReport<2>&);
template void measure_motion<3>(const State<3>&, StepReport<3>&);
template void faces_to_points<2>(State<2>&, double, StepReport<2>&);
template void faces_to_points<3>(State<3>&, double, StepReport<3>&);

}  // namespace quicksand

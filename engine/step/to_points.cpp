// Faces → points: velocities, strains and stress, porosity, positions.

#include <cmath>
#include <limits>

#include "engine/step/batches.hpp"
#include "engine/step/chunks.hpp"
#include "engine/step/move_point.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"
#include "engine/step/step.hpp"

namespace quicksand {
namespace {

/// Totals of one block; summed over blocks in their order.
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

/// FLIP with a little PIC: the point keeps its own velocity plus the grid's change, and relaxes to the
/// grid's velocity at `pic_rate`, a rate so that the damping does not depend on the time step. The affine
/// transfer takes the grid's velocity as it is (`pic` = 1): what PIC would lose is in the gradient.
template <int D>
double mix(double own, double old_grid, double new_grid, double pic) {
  return (1 - pic) * (own + new_grid - old_grid) + pic * new_grid;
}

/// One face's part in the gradient of component d that the affine transfer keeps.
template <class S, int D>
void add_slope(const Grid<D>& grid, const FaceWeight<D>& weight, double velocity, Vec<D>& slope) {
  const Vec<D> a = affine_weight<typename S::Shape>(weight, grid.inverse_h);
  for (int j = 0; j < D; ++j) slope[j] += velocity * a[j];
}

/// Distance above the water surface, in cells, from which a drop falls freely instead of moving with it.
/// Points of a surface at rest lie a quarter of a cell below it.
constexpr double kFreeHeight = 0.25;

template <int D, class Kernel>
bool falls_freely(const State<D>& s, const Kernel& kernel) {
  if (s.cell[kernel.home()].confined) return false;
  double depth = 0;
  for_centers(s.grid, s.water_walls, kernel, [&](int c, double w) { depth += w * s.cell[c].depth; });
  return depth < -kFreeHeight;
}

/// Gives a water point its new velocity. Returns its way by the kernel's own velocity, m.
template <class S, int D, class Kernel>
Vec<D> new_water_velocity(State<D>& s, std::uint32_t p, const Kernel& kernel, bool falls, double dt,
                          double pic, Totals<D>& totals) {
  WaterPoints<D>& water = s.water;
  Vec<D> step;
  double speed2 = 0;
  const bool open = !S::affine && !falls && !s.water_walls.folds(kernel.home());
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    double carried = 0;
    Lanes<2> at_point{};  // before and after the step
    Vec<D> slope{};
    if (open)
      for_rows(s.grid, kernel, d, [&](const auto& row) {
        Lanes<2> sum{};
        for (std::size_t i = 0; i < row.x.size(); ++i)
          sum += row.x[i] * lanes_from<2>(s.speeds[d][row.first + i].water_old);
        at_point += row.w * sum;
      });
    else
      for_faces(s.grid, s.water_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
        Lanes<2> at_face = lanes_from<2>(s.speeds[d][face].water_old);
        if (falls && s.flow[d][face].wet > 1) {
          const double lift = at_face[1] - at_face[0] - dt * s.constants.fall(d);
          at_face[1] -= lift;
          carried += sign * weight.w * lift;
        }
        at_point += sign * weight.w * at_face;
        if constexpr (S::affine) add_slope<S, D>(s.grid, weight, sign * at_face[1], slope);
      });
    if constexpr (S::affine) water.affine[p][d] = slope;
    double& v = water.v[p][d];
    v = mix<D>(v, at_point[0], at_point[1], pic);
    totals.let_go[d] -= water.mass[p] * carried;
    step[d] = dt * at_point[1];
    totals.momentum[d] += water.mass[p] * v;
    speed2 += v * v;
  });
  totals.mass += water.mass[p];
  totals.kinetic += 0.5 * water.mass[p] * speed2;
  totals.max_speed2 = std::max(totals.max_speed2, speed2);
  totals.finite = totals.finite && std::isfinite(speed2);
  return step;
}

/// Way of the water in dt by the velocity that carries it, m.
template <int D, class Kernel>
QUICKSAND_INLINE Vec<D> carried_way(const State<D>& s, const Kernel& mover, double dt) {
  const bool open = !s.water_walls.folds(mover.home());
  return from_components<D>([&](auto d) {
    double v = 0;
    if (open)
      for_rows(s.grid, mover, d, [&](const auto& row) {
        double sum = 0;
        for (std::size_t i = 0; i < row.x.size(); ++i) sum += row.x[i] * s.speeds[d][row.first + i].water;
        v += row.w * sum;
      });
    else
      for_faces(s.grid, s.water_walls, mover, d, [&](int face, double w, double sign, const Vec<D>&) {
        v += sign * w * s.speeds[d][face].water;
      });
    return dt * v;
  });
}

/// Points move by the midpoint rule; Euler's way leads out of every bend. Half the way by the kernel's own
/// velocity is near enough for the middle. Drops fall straight on.
template <class S, int D>
void water_from_faces(State<D>& s, const PointBatch<D, typename S::Shape>& batch, double dt, double pic,
                      Totals<D>& totals) {
  using Mover = KernelBatch<D, typename S::Shape::Mover>;
  std::array<Vec<D>, Mover::size> step;
  std::array<Lanes<Mover::size>, D> middle{};
  std::array<bool, Mover::size> falls;
  for (int k = 0; k < batch.count; ++k) {
    const std::uint32_t p = batch.point[k];
    const auto kernel = batch.kernel[k];
    falls[k] = falls_freely(s, kernel);
    step[k] = new_water_velocity<S>(s, p, kernel, falls[k], dt, pic, totals);
    Vec<D> half = step[k];
    for (double& component : half) component *= 0.5;
    Vec<D> x = s.water.x[p];
    move_point<D>(s.grid, s.water_walls, kernel.home(), x, half);
    for (int d = 0; d < D; ++d) middle[d][k] = x[d];
  }
  Mover mover;
  mover.find(s.grid, middle);
  for (int k = 0; k < batch.count; ++k) {
    const Vec<D> way = falls[k] ? step[k] : carried_way(s, mover[k], dt);
    totals.interventions.clipped_points +=
        move_point<D>(s.grid, s.water_walls, batch.kernel[k].home(), s.water.x[batch.point[k]], way);
  }
}

template <class S, int D, class Kernel>
void soil_from_faces(State<D>& s, std::uint32_t p, const Kernel& kernel, double dt, double pic,
                     Totals<D>& totals) {
  SoilPoints<D>& soil = s.soil;
  const SoilMaterial& material = s.constants.soils[soil.soil[p]];
  Vec<D> step;
  Gradient<D> l{};
  double speed2 = 0;
  const bool open = !S::affine && !s.soil_walls.folds(kernel.home());
  for_components<D>([&](auto d) __attribute__((always_inline)) {
    Lanes<2> at_point{};  // before and after the step
    Vec<D> slope{};
    if (open)
      for_rows(s.grid, kernel, d, [&](const auto& row) {
        Lanes<2> sum{};
        double difference = 0;
        for (std::size_t i = 0; i < row.x.size(); ++i) {
          const Lanes<2> at_face = lanes_from<2>(s.speeds[d][row.first + i].soil_old);
          sum += row.x[i] * at_face;
          difference += row.dx[i] * at_face[1];
        }
        at_point += row.w * sum;
        l[d][0] += row.gradient[0] * difference;
        for (int j = 1; j < D; ++j) l[d][j] += row.gradient[j] * sum[1];
      });
    else
      for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, const FaceWeight<D>& weight, double sign) {
        const Lanes<2> at_face = sign * lanes_from<2>(s.speeds[d][face].soil_old);
        at_point += weight.w * at_face;
        for (int j = 0; j < D; ++j) l[d][j] += at_face[1] * weight.gradient[j];
        if constexpr (S::affine) add_slope<S, D>(s.grid, weight, at_face[1], slope);
      });
    if constexpr (S::affine) soil.affine[p][d] = slope;
    double& v = soil.v[p][d];
    v = mix<D>(v, at_point[0], at_point[1], pic);
    step[d] = dt * at_point[1];
    totals.momentum[d] += soil.mass[p] * v;
    speed2 += v * v;
  });
  const double hoop = S::axial ? step[0] / (dt * soil.x[p][0]) : 0;  // 1/s, v_r/r
  totals.interventions.clipped_points += move_point<D>(s.grid, s.soil_walls, kernel.home(), soil.x[p], step);

  // Dˢn/Dt = (1−n) ∇·vˢ, integrated: the grains' volume stays. A step that turns the soil has ∇·vˢ < 0, as
  // its chords lead inward of their arcs; the determinant knows.
  const double before = soil.porosity[p];
  const double stretch = volume_ratio<D>(l, dt) * (1 + dt * hoop);
  const double exact = 1 - (1 - before) / std::max(stretch, 0.1);
  const double n = soil.porosity[p] = std::clamp(exact, kMinRoom, kMaxPorosity);
  totals.interventions.clamped_values += n != exact;

  SoilState<D> state = soil_state(soil, p);
  if (n > material.max_porosity)
    state.stress = {};  // the grains do not touch
  else
    totals.interventions.clamped_values += update_state<D>(material, state, before, l, dt, hoop);
  set_soil_state(soil, p, state);
  // Next to the air no pressure resists, so that the frame's own wave is the bound. Grains that do not touch
  // may touch again in the next step.
  const double touching = std::min(n, material.max_porosity);
  const double modulus = material.constrained_modulus<D>(state, touching);
  const StepLimit& limit = s.constants.step_limits[soil.soil[p]];
  const bool confined = s.cell[kernel.home()].confined;
  totals.soil_limit = std::min(totals.soil_limit,
                               confined ? limit.saturated(touching, modulus) : limit.dry(touching, modulus));
  if (s.constants.explicit_pressure)
    totals.fast_wave_limit = std::min(totals.fast_wave_limit, limit.fast_wave(touching, modulus));
  totals.mass += soil.mass[p];
  totals.kinetic += 0.5 * soil.mass[p] * speed2;
  totals.max_speed2 = std::max(totals.max_speed2, speed2);
  totals.max_soil_speed2 = std::max(totals.max_soil_speed2, speed2);
  totals.finite = totals.finite && std::isfinite(speed2) && std::isfinite(trace(state.stress));
}

template <int D>
void publish_speeds(State<D>& s) {
  const auto publish = [&](int d, std::size_t i) {
    const FaceFlow& f = s.flow[d][i];
    s.speeds[d][i] = {f.soil_old, f.soil, f.water_old, f.water};
  };
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, true, [&](int i, const Cell<D>&) {
      for (int d = 0; d < D; ++d) publish(d, i);
    });
  });
  for (std::size_t ghost = s.grid.count(); ghost < s.flow[kPlateAxis].size(); ++ghost)
    publish(kPlateAxis, ghost);
}

}  // namespace

template <int D>
void faces_to_points(State<D>& s, double dt, StepReport<D>& report) {
  publish_speeds(s);
  const double pic = s.constants.transfer == Transfer::apic ? 1 : 1 - std::exp(-s.constants.pic_rate * dt);
  const Supports<D> supports = support_impulses(s, dt, pic);
  report.impulse_walls = supports.walls;
  report.impulse_surface = supports.surface;
  report.impulse_damping = supports.damping;
  report.damped = supports.damped;
  const Totals<D> totals = with_scheme(s, [&](auto scheme) {
    using S = decltype(scheme);
    using Shape = typename S::Shape;
    return s.blocks.template sum<Totals<D>>([&](int b) {
      Totals<D> t;
      for_points<Shape>(s.grid, s.soil.x, s.soil_blocks, b, [&](std::uint32_t p, const auto& kernel) {
        soil_from_faces<S>(s, p, kernel, dt, pic, t);
      });
      for_batches<Shape>(s.grid, s.water.x, s.water_blocks, b,
                         [&](const auto& batch) { water_from_faces<S>(s, batch, dt, pic, t); });
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

#include "tests/extremes/invariants.hpp"

#include <cmath>
#include <cstdio>

namespace quicksand::test {

std::string figure(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", value);
  return buffer;
}

namespace {

double size(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

double diagonal(const Scene& s) {
  double sum = 0;
  for (std::size_t d = 0; d < (s.domain.dimension == Dimension::space ? 3u : 2u); ++d)
    sum += std::pow(s.domain.max[d] - s.domain.min[d], 2);
  return std::sqrt(sum);
}

/// What no impulse accounts for, of what drove the motion: rounding leaves up to 1e-5 at drags of 1e-14 m/s.
/// Not beside reservoirs, whose push counts as no drive.
void check_momentum(const Scene& s, const Ledger& l, Broken& broken) {
  constexpr double kAgree = 1e-4;
  if (s.reservoirs.empty() && l.momentum_residual > kAgree)
    broken.push_back("momentum off by " + figure(l.momentum_residual) + " of what drove it");
}

/// A sum in another order may differ by rounding; nothing else may.
constexpr double kMassRounding = 1e-11;
void check_masses(const Ledger& l, Broken& broken) {
  const double water = l.water_mass_initial + l.water_in - l.water_out - l.water_removed;
  const double soil = l.solid_mass_initial - l.soil_out - l.soil_removed;
  if (std::abs(l.water_mass - water) > kMassRounding * (l.water_mass_initial + l.water_in))
    broken.push_back("water mass " + figure(l.water_mass) + " of " + figure(water));
  if (std::abs(l.solid_mass - soil) > kMassRounding * l.solid_mass_initial)
    broken.push_back("solid mass " + figure(l.solid_mass) + " of " + figure(soil));
  if (l.deleted_points) broken.push_back("points deleted: " + std::to_string(l.deleted_points));
}

/// Every value of frames and samples. Returns false at the first that is none.
bool check_finite(const Recorder& results, Broken& broken) {
  for (const Frame& frame : results.frames) {
    for (const double x : frame.position)
      if (!std::isfinite(x)) return broken.push_back("position at " + figure(frame.time) + " s"), false;
    for (const FrameField& f : frame.fields)
      for (const float value : f.values)
        if (!std::isfinite(value))
          return broken.push_back(f.name + " at " + figure(frame.time) + " s"), false;
  }
  for (const auto& row : results.rows())
    for (const double value : row)
      if (!std::isfinite(value)) return broken.push_back("a series is not finite"), false;
  return true;
}

/// Outside by more than rounding of a coordinate of the domain's size.
void check_walls(const Scene& s, const Recorder& results, Broken& broken) {
  const std::size_t axes = s.domain.dimension == Dimension::space ? 3 : 2;
  const double slack = 1e-9 * s.cell_size();
  for (const Frame& frame : results.frames)
    for (std::size_t p = 0; p < frame.points(); ++p) {
      const double* x = &frame.position[3 * p];
      for (std::size_t d = 0; d < axes; ++d)
        if (x[d] < s.domain.min[d] - slack || x[d] > s.domain.max[d] + slack)
          return broken.push_back("point outside the domain at " + figure(frame.time) + " s");
      for (const Wall& wall : s.walls) {
        if (!wall.block) continue;
        bool inside = true;
        for (std::size_t d = 0; d < axes; ++d)
          inside = inside && x[d] > wall.block->min[d] + slack && x[d] < wall.block->max[d] - slack;
        if (inside) return broken.push_back("point in a block at " + figure(frame.time) + " s");
      }
    }
}

/// Heights of water that may press: the domain's, the highest reservoir's.
double fall_height(const Scene& s) {
  double height = diagonal(s);
  const auto consider = [&](double head) { height = std::max(height, head - s.domain.min[1] + diagonal(s)); };
  for (const Reservoir& r : s.reservoirs) consider(r.head);
  for (const Stage& stage : s.stages)
    for (const auto& [name, head] : stage.heads) consider(head);
  return height;
}

double largest_load(const Scene& s) {
  double load = 0;
  for (const Load& l : s.loads) {
    load += size(l.traction);
    double area = std::abs(l.plate.to[0] - l.plate.from[0]);  // per metre in the plane
    if (s.domain.dimension == Dimension::space) area *= std::abs(l.plate.to[2] - l.plate.from[2]);
    if (s.domain.dimension == Dimension::axisymmetric) area *= 0.5 * (l.plate.to[0] + l.plate.from[0]);
    if (l.plate_force) load += size(*l.plate_force) / area;
  }
  return load;
}

/// What can have been put in: motion and strain at the start, weight over the whole domain (in the extreme
/// the highest reservoir's head), loads over the whole domain, pressures at the start over the whole volume.
/// An upper bound, loose by design: it is there to catch what runs away.
void check_energy(const Scene& s, const Ledger& l, const Recorder& results, Broken& broken) {
  const auto kinetic = results.series("ledger.energy_kinetic"),
             strain = results.series("ledger.energy_strain");
  const double mass = l.water_mass_initial + l.water_in + l.solid_mass_initial;
  const double volume = l.water_volume_initial + mass / 100;  // m³: nothing is lighter than 100 kg/m³
  double pressure = s.initial.uniform_pressure + largest_load(s);
  for (const double stress : s.initial.uniform_stress) pressure += std::abs(stress);
  for (const Load& load : s.loads)  // a plate that is driven gives what it takes
    if (load.kind == Load::Kind::plate && !load.plate_force) return;
  const double put_in =
      kinetic.front() + strain.front() + mass * size(s.gravity) * fall_height(s) + pressure * volume;
  // Symplectic steps keep an energy that differs from the true one by up to the part ω Δt / 2 at their bound.
  constexpr double kSwing = 1.1;
  for (std::size_t k = 0; k < kinetic.size(); ++k)
    if (kinetic[k] > put_in * kSwing || strain[k] > put_in * kSwing)
      return broken.push_back("energy " + figure(kinetic[k]) + " + " + figure(strain[k]) + " J of " +
                              figure(put_in) + " J put in");
}

/// Weight of the highest column of water and grains, loads, what is given at the start, and the hammer of
/// water stopped at its largest speed (ρ c v, with the speed that a pressure can cross the scene within the
/// step), and what compresses the pore water, Kw/n, when a plate is driven into it. Three times.
void check_pressure(const Scene& s, const RunReport& report, const Recorder& results, Broken& broken) {
  double dense = s.water.density;
  for (const auto& [name, soil] : s.soils) dense = std::max(dense, soil.grain_density);
  double fastest = 0;
  for (const double v : results.series("max_speed")) fastest = std::max(fastest, v);
  for (const Frame& frame : results.frames)  // frames may be closer together than samples
    for (const FrameField& f : frame.fields)
      if (f.name == "velocity")
        for (std::size_t p = 0; p < frame.points(); ++p)
          fastest = std::max<double>(fastest,
                                     std::hypot(f.values[3 * p], f.values[3 * p + 1], f.values[3 * p + 2]));
  double given = std::abs(s.initial.uniform_pressure) + largest_load(s), stiff = 0;
  for (const double stress : s.initial.uniform_stress) given += std::abs(stress);
  for (const auto& [name, soil] : s.soils) stiff = std::max(stiff, soil.model.young_modulus);
  double porosity = 1, inertia = 1;
  for (const auto& [name, soil] : s.soils) porosity = std::min(porosity, soil.porosity);
  for (const Load& load : s.loads) {
    fastest = std::max(fastest, size(load.plate_velocity));
    const double strain = size(load.plate_velocity) * report.sim_time / s.cell_size();
    given += std::min(1.0, strain) * s.water.bulk_modulus.value_or(0) / porosity;  // rigid grains between
  }
  for (const QuasiStaticReport& stage : report.quasi_static) inertia = std::max(inertia, stage.inertia);
  dense *= inertia;
  const double across = diagonal(s) / std::max(report.time_step_min, 1e-300);
  const double bound = 3 * (dense * size(s.gravity) * fall_height(s) + given + dense * fastest * fastest +
                            dense * across * fastest);
  for (const Frame& frame : results.frames)
    for (const FrameField& f : frame.fields) {
      if (f.name != "pore_pressure") continue;
      for (const float p : f.values)
        if (std::abs(p) > bound)
          return broken.push_back("pressure " + figure(p) + " Pa of at most " + figure(bound));
    }
}

double largest_pressure(const Recorder& results) {
  double largest = 0;
  for (const Frame& frame : results.frames)
    for (const FrameField& f : frame.fields)
      if (f.name == "pore_pressure")
        for (const float p : f.values) largest = std::max(largest, std::abs(static_cast<double>(p)));
  return largest;
}

/// What of the water's volume is lost or won for good: the room that it takes less what it holds, as a mean
/// over the second half of the run (points crowd for a moment where bodies strike). Within 1 % of what water
/// and the grains among it fill (kernels measure both together), and what its own compressibility adds. Not
/// where the scene switched the feedback off, and not where the run itself says so (RunReport::cautions).
void check_water_volume(const Scene& s, const RunReport& report, const Recorder& results, Broken& broken) {
  if (!report.cautions.empty()) return;  // the answer was told with it
  const Ledger& l = report.ledger;
  double duration = 0, grains = 0;
  for (const Stage& stage : s.stages) duration += stage.duration;
  if (l.water_volume_initial <= 0 || s.numerics.drift_time == 0 || s.numerics.drift_time > 0.2 * duration)
    return;
  for (const auto& [name, soil] : s.soils)
    grains = std::max(grains, l.solid_mass_initial / soil.grain_density);
  const double elastic = s.water.bulk_modulus ? largest_pressure(results) / *s.water.bulk_modulus : 0;
  const double allowed = 0.01 * (1 + grains / l.water_volume_initial) + elastic;
  const double drift = l.water_volume_drift;
  if (std::abs(drift) > allowed)
    broken.push_back("water volume off by " + figure(drift) + " of " + figure(allowed));
}

}  // namespace

Broken invariants(const Scene& scene, const RunReport& report, const Recorder& results) {
  Broken broken;
  if (!check_finite(results, broken)) return broken;
  check_walls(scene, results, broken);
  if (report.status == RunStatus::failed) return broken;
  check_masses(report.ledger, broken);
  check_momentum(scene, report.ledger, broken);
  check_water_volume(scene, report, results, broken);
  check_energy(scene, report.ledger, results, broken);
  check_pressure(scene, report, results, broken);
  return broken;
}

}  // namespace quicksand::test

#include "engine/run/watch.hpp"

#include <algorithm>
#include <cmath>

#include "engine/run/sampling.hpp"

namespace quicksand {
namespace {

template <int D>
Vec<D> place(const Vec3& at) {
  Vec<D> x;
  for (int d = 0; d < D; ++d) x[d] = at[d];
  return x;
}

/// A probe's place, moved off the faces of blocks that count as the block's own (a cell holds its lower
/// faces), by a share of a cell that shows in no figure.
template <int D>
Vec<D> off_blocks(const State<D>& s, const Vec<D>& x) {
  constexpr double kStep = 1e-6;  // of a cell: far above rounding
  const auto blocked = [&](const Vec<D>& y) {
    return s.water_walls.blocked(s.grid.index(s.grid.cell_of(y)));
  };
  Vec<D> y = x;
  for (int axes = 1; axes < (1 << D) && blocked(y); ++axes)
    for (int d = 0; d < D; ++d) y[d] = x[d] - ((axes >> d) & 1) * kStep * s.grid.h;
  return blocked(y) ? x : y;
}

/// Upward unit vector, against gravity; y without gravity.
template <int D>
Vec<D> up(const Vec<D>& gravity) {
  double g = 0;
  for (double c : gravity) g += c * c;
  Vec<D> u{};
  u[kUp] = 1;
  if (g > 0)
    for (int d = 0; d < D; ++d) u[d] = -gravity[d] / std::sqrt(g);
  return u;
}

/// Of the points that a body has left; `last` once it has none.
template <int D>
BodyRise rise_of(const State<D>& s, int body, const BodyRise& last) {
  const Vec<D> u = up<D>(s.constants.gravity);
  BodyRise r;
  double mass = 0;
  for (std::size_t p = 0; p < s.soil.size(); ++p) {
    if (s.soil.body[p] != body) continue;
    double along = 0, square = 0;
    for (int d = 0; d < D; ++d) {
      const double move = s.soil.x[p][d] - s.soil.start[p][d];
      along += move * u[d];
      square += move * move;
    }
    r.mean += s.soil.mass[p] * along;
    r.largest = std::max(r.largest, std::sqrt(square));
    mass += s.soil.mass[p];
  }
  r.mean /= mass;
  return mass > 0 ? r : last;
}

struct Quantity {
  const char* unit;
  int components;
};
Quantity quantity(const std::string& name) {
  if (name == "pore_pressure") return {"Pa", 1};
  if (name == "head") return {"m", 1};
  if (name == "porosity") return {"1", 1};
  return {"m/s", 3};
}

template <int D>
void append_probe(const State<D>& s, const Probe& probe, std::vector<double>& out) {
  const Vec<D> x = off_blocks<D>(s, place<D>(probe.at));
  if (probe.quantity == "pore_pressure") {
    out.push_back(pressure_at<D>(s, x));
  } else if (probe.quantity == "head") {
    out.push_back(head_at<D>(s, x, pressure_at<D>(s, x)));
  } else if (probe.quantity == "porosity") {
    out.push_back(porosity_at<D>(s, x));
  } else {
    const Vec<D> v =
        probe.quantity == "soil_velocity" ? soil_velocity_at<D>(s, x) : water_velocity_at<D>(s, x);
    for (int d = 0; d < 3; ++d) out.push_back(d < D ? v[d] : 0);
  }
}

}  // namespace

template <int D>
Watch<D>::Watch(const Scene& scene) : scene_(scene) {
  ports_ = !scene.reservoirs.empty();
  for (const Side& side : scene.domain.sides) ports_ = ports_ || side.kind == SideKind::open;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].kind != BodyKind::water && !scene.bodies[b].fixed)
      moving_soil_.push_back(static_cast<int>(b));
  rise_.resize(moving_soil_.size());
  for (const Stage& stage : scene.stages) {
    quasi_static_ = quasi_static_ || stage.quasi_static;
    damps_ = damps_ || stage.damping > 0;
    removes_ = removes_ || !stage.remove_bodies.empty();
  }
  if (!scene.output.heave) return;
  HeaveReport report;
  for (const Body& body : scene.bodies)
    if (body.name == scene.output.heave->body) {
      const Soil& soil = scene.soils.at(body.soil);
      report.critical_gradient = (1 - soil.porosity) * (soil.grain_density / scene.water.density - 1);
    }
  heave_.push_back(report);
  Vec<D> gravity;
  for (int d = 0; d < D; ++d) gravity[d] = scene.gravity[d];
  const Vec<D> u = up<D>(gravity);
  for (const Probe& probe : scene.output.probes)
    for (int d = 0; d < D; ++d) {
      if (probe.name == scene.output.heave->above) probe_distance_ += u[d] * probe.at[d];
      if (probe.name == scene.output.heave->below) probe_distance_ -= u[d] * probe.at[d];
    }
}

template <int D>
std::vector<SeriesInfo> Watch<D>::info() const {
  std::vector<SeriesInfo> all;
  for (const Probe& probe : scene_.output.probes) {
    const Quantity q = quantity(probe.quantity);
    all.push_back({"probe." + probe.name, q.unit, q.components});
  }
  for (const Load& load : scene_.loads) {
    if (load.kind != Load::Kind::plate) continue;
    all.push_back({"plate." + load.name + ".movement", "m", 1});
    all.push_back({"plate." + load.name + ".force", "N", 1});
  }
  for (const Section& section : scene_.output.sections) all.push_back({"section." + section.name, "m³/s", 1});
  for (const Reservoir& reservoir : scene_.reservoirs) {
    all.push_back({"reservoir." + reservoir.name + ".level", "m", 1});
    all.push_back({"reservoir." + reservoir.name + ".inflow", "m³/s", 1});
  }
  for (int b : moving_soil_) {
    all.push_back({"body." + scene_.bodies[b].name + ".rise", "m", 1});
    all.push_back({"body." + scene_.bodies[b].name + ".largest_displacement", "m", 1});
  }
  all.push_back({"ledger.water_volume", "m³", 1});
  all.push_back({"ledger.water_mass", "kg", 1});
  all.push_back({"ledger.solid_mass", "kg", 1});
  if (ports_) {
    all.push_back({"ledger.water_in", "kg", 1});
    all.push_back({"ledger.water_out", "kg", 1});
    all.push_back({"ledger.soil_out", "kg", 1});
    all.push_back({"ledger.impulse_flow", "N·s", 3});
  }
  if (removes_) {
    all.push_back({"ledger.water_removed", "kg", 1});
    all.push_back({"ledger.soil_removed", "kg", 1});
    all.push_back({"ledger.impulse_removed", "N·s", 3});
  }
  all.push_back({"ledger.energy", "J", 1});
  all.push_back({"ledger.energy_kinetic", "J", 1});
  all.push_back({"ledger.energy_potential", "J", 1});
  all.push_back({"ledger.energy_strain", "J", 1});
  all.push_back({"ledger.momentum", "N·s", 3});
  all.push_back({"ledger.impulse_gravity", "N·s", 3});
  all.push_back({"ledger.impulse_walls", "N·s", 3});
  all.push_back({"ledger.impulse_surface", "N·s", 3});
  all.push_back({"ledger.impulse_loads", "N·s", 3});
  all.push_back({"ledger.impulse_stages", "N·s", 3});
  if (damps_) {
    all.push_back({"ledger.impulse_damping", "N·s", 3});
    all.push_back({"ledger.energy_damped", "J", 1});
  }
  all.push_back({"ledger.clipped_points", "1", 1});
  all.push_back({"ledger.clamped_values", "1", 1});
  all.push_back({"ledger.cut_steps", "1", 1});
  all.push_back({"ledger.retries", "1", 1});
  all.push_back({"time_step", "s", 1});
  all.push_back({"pressure_iterations", "1", 1});
  all.push_back({"max_speed", "m/s", 1});
  all.push_back({"max_soil_speed", "m/s", 1});
  if (quasi_static_) {
    all.push_back({"quasi_static.inertia", "1", 1});
    all.push_back({"quasi_static.inertia_ratio", "1", 1});
  }
  return all;
}

template <int D>
std::vector<double> Watch<D>::sample(const State<D>& s, const StepReport<D>& step, const Ledger& l) {
  std::vector<double> out;
  for (const Probe& probe : scene_.output.probes) append_probe(s, probe, out);
  for (const Plate<D>& plate : s.plates) out.insert(out.end(), {plate.sunk, plate.reaction});
  for (const Section& section : scene_.output.sections) out.push_back(flow_through(s, section.line));
  for (const ReservoirState& r : s.reservoirs) out.insert(out.end(), {r.level(s.time), r.inflow});
  for (std::size_t k = 0; k < moving_soil_.size(); ++k) {
    rise_[k] = rise_of(s, moving_soil_[k], rise_[k]);
    out.insert(out.end(), {rise_[k].mean, rise_[k].largest});
  }
  const double energy = l.energy_kinetic + l.energy_potential + l.energy_strain;
  out.insert(out.end(), {l.water_volume, l.water_mass, l.solid_mass});
  if (ports_) {
    out.insert(out.end(), {l.water_in, l.water_out, l.soil_out});
    out.insert(out.end(), l.impulse_flow.begin(), l.impulse_flow.end());
  }
  if (removes_) {
    out.insert(out.end(), {l.water_removed, l.soil_removed});
    out.insert(out.end(), l.impulse_removed.begin(), l.impulse_removed.end());
  }
  out.insert(out.end(), {energy, l.energy_kinetic, l.energy_potential, l.energy_strain});
  for (int d = 0; d < 3; ++d) out.push_back(d < D ? step.momentum[d] : 0);
  for (const auto* impulse :
       {&l.impulse_gravity, &l.impulse_walls, &l.impulse_surface, &l.impulse_loads, &l.impulse_stages})
    out.insert(out.end(), impulse->begin(), impulse->end());
  if (damps_) {
    out.insert(out.end(), l.impulse_damping.begin(), l.impulse_damping.end());
    out.push_back(l.energy_damped);
  }
  out.insert(out.end(), {static_cast<double>(l.clipped_points), static_cast<double>(l.clamped_values),
                         static_cast<double>(l.cut_steps), static_cast<double>(l.retries), step.dt,
                         static_cast<double>(step.pressure.iterations), step.max_speed, step.max_soil_speed});
  if (quasi_static_) {
    out.push_back(s.constants.inertia);
    out.push_back(inertia_ratio(l.energy_kinetic, l.energy_strain));
  }
  sample_rise(s.time);
  return out;
}

template <int D>
double Watch<D>::head_of(const State<D>& s, const std::string& name) const {
  for (const Probe& probe : scene_.output.probes)
    if (probe.name == name) return head_at<D>(s, place<D>(probe.at), pressure_at<D>(s, place<D>(probe.at)));
  return 0;
}

template <int D>
void Watch<D>::track(const State<D>& s) {
  if (heave_.empty() || heave_.front().moved) return;
  HeaveReport& report = heave_.front();
  const double difference = head_of(s, scene_.output.heave->below) - head_of(s, scene_.output.heave->above);
  if (!(difference > report.head_difference)) return;
  report.head_difference = difference;
  report.gradient = difference / probe_distance_;
}

template <int D>
void Watch<D>::sample_rise(double time) {
  if (heave_.empty()) return;
  HeaveReport& report = heave_.front();
  for (std::size_t k = 0; k < moving_soil_.size(); ++k) {
    if (scene_.bodies[moving_soil_[k]].name != scene_.output.heave->body) continue;
    const BodyRise& r = rise_[k];
    report.final_rise = r.mean;
    report.max_rise = std::max(report.max_rise, r.mean);
    report.max_point_displacement = std::max(report.max_point_displacement, r.largest);
    if (report.moved || r.mean <= scene_.output.heave->threshold) continue;
    report.moved = true;
    report.time = time;
  }
}

template class Watch<2>;
template class Watch<3>;

}  // namespace quicksand

#include "engine/run/soundness.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/run/watch.hpp"
#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Symplectic steps keep an energy that differs from the true one by up to the part ω Δt / 2 at their bound.
constexpr double kSwing = 1.1;
/// Several causes act at once, and a corner of three walls multiplies; what runs away passes this at once.
constexpr double kMostPressure = 30;
constexpr long kStepsBetweenLooks = 16;  // a pass over points costs about a twentieth of a step
constexpr double kMostDrift = 0.01;

double size(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", value);
  return buffer;
}

template <int D>
double largest_in(const State<D>& s) {
  double largest = 0;
  for (const double p : s.pressure_system.solution) largest = std::max(largest, std::abs(p));
  return largest;
}

double load_pressure(const Scene& scene) {
  double pressure = 0;
  for (const Load& load : scene.loads) {
    pressure += size(load.traction);
    if (!load.plate_force) continue;
    const Vec3 &from = load.plate.from, &to = load.plate.to;
    double area = std::abs(to[0] - from[0]);  // per metre in the plane
    if (scene.domain.dimension == Dimension::space) area *= std::abs(to[2] - from[2]);
    if (scene.domain.dimension == Dimension::axisymmetric) area *= 0.5 * (to[0] + from[0]);
    pressure += size(*load.plate_force) / area;
  }
  return pressure;
}

/// N, of all loads with nothing taken off for what pushes against another.
template <int D>
double load_force(const State<D>& s) {
  double force = 0;
  for (const SurfaceLoad<D>& load : s.loads) {
    double area = 0, traction2 = 0;
    for (const LoadMarker<D>& marker : load.markers) area += marker.area;
    for (const double t : load.traction) traction2 += t * t;
    force += std::sqrt(traction2) * area;
  }
  for (const Plate<D>& plate : s.plates) force += plate.driven ? 0 : std::abs(plate.force);
  return force;
}

double fastest_plate(const Scene& scene) {
  double speed = 0;
  for (const Load& load : scene.loads) speed = std::max(speed, size(load.plate_velocity));
  return speed;
}

bool only_plates_are_driven(const Scene& scene) {
  return std::all_of(scene.loads.begin(), scene.loads.end(),
                     [](const Load& load) { return load.kind == Load::Kind::plate && !load.plate_force; });
}

}  // namespace

template <int D>
Soundness<D>::Soundness(const Scene& scene, const State<D>& start, const StepReport<D>& motion)
    : scene_(scene), highest_head_(scene.domain.min[1]), dense_(scene.water.density) {
  for (int d = 0; d < D; ++d) diagonal_ += std::pow(scene.domain.max[d] - scene.domain.min[d], 2);
  diagonal_ = std::sqrt(diagonal_);
  for (const Reservoir& r : scene.reservoirs) highest_head_ = std::max(highest_head_, r.head);
  for (const Stage& stage : scene.stages)
    for (const auto& [name, head] : stage.heads) highest_head_ = std::max(highest_head_, head);
  double porosity = 1;
  for (const auto& [name, soil] : scene.soils) {
    dense_ = std::max(dense_, soil.grain_density);
    porosity = std::min(porosity, soil.porosity);
  }
  storage_ = scene.water.bulk_modulus.value_or(0) / porosity;
  given_pressure_ = std::abs(scene.initial.uniform_pressure) + load_pressure(scene);
  for (const double stress : scene.initial.uniform_stress) given_pressure_ += std::abs(stress);
  double volume = 0;
  for (const double mass : start.water.mass) volume += mass / scene.water.density;
  double confined = 0;  // Pa · m³ of stress at the start, above its energy in soil that stiffens
  for (const double stress : scene.initial.uniform_stress) confined += std::abs(stress);
  double solid = 0;
  for (std::size_t p = 0; p < start.soil.size(); ++p) {
    const Soil& soil = scene.soils.at(scene.bodies[start.soil.body[p]].soil);
    solid += start.soil.mass[p] / (soil.grain_density * (1 - soil.porosity));
  }
  given_energy_ = std::abs(scene.initial.uniform_pressure) * volume + confined * solid;
  energy_at_start_ = motion.kinetic + strain_energy(start);
  moving_mass_ = motion.moving_mass;
  force_ = load_force(start);
  fastest_ = std::max(motion.max_speed, fastest_plate(scene));
}

/// An upper bound, loose by design: motion, strain and pressure at the start, the weight of all that moves
/// falling from the highest head and across the domain, loads across the domain.
template <int D>
double Soundness<D>::put_in() const {
  const double g = size(scene_.gravity);
  const double flows = (moving_mass_ + water_in_) * g * (highest_head_ - scene_.domain.min[1] + diagonal_);
  const double loads = only_plates_are_driven(scene_) ? 0 : 2 * force_ * diagonal_;
  return energy_at_start_ + given_energy_ + flows + loads + driven_work_;
}

/// Weight of the highest column, loads, what is given at the start, the hammer of water stopped within a step
/// all across the domain, and what compresses the pore water under a driven plate.
template <int D>
double Soundness<D>::largest_pressure() const {
  const double height = highest_head_ - scene_.domain.min[1] + diagonal_, g = size(scene_.gravity);
  double driven = 0;
  for (const Stage& stage : scene_.stages) driven += stage.duration * fastest_plate(scene_);
  const double strain = std::min(1.0, driven / scene_.cell_size());
  const double dense = dense_ * inertia_;
  return kMostPressure * (dense_ * g * height + given_pressure_ + strain * storage_ +
                          dense * fastest_ * (fastest_ + diagonal_ / shortest_step_));
}

template <int D>
std::optional<Unsound> Soundness<D>::add(const State<D>& s, const StepReport<D>& step, const Ledger& ledger,
                                         bool look) {
  fastest_ = std::max(fastest_, step.max_speed);
  shortest_step_ = shortest_step_ > 0 ? std::min(shortest_step_, step.dt) : step.dt;
  inertia_ = std::max(inertia_, s.constants.inertia);
  water_in_ = ledger.water_in;
  double impulse = 0;
  for (const double part : step.impulse_loads) impulse += part * part;
  impulse = std::sqrt(impulse);
  if (step.dt > 0) force_ = std::max(force_, impulse / step.dt);
  driven_work_ += impulse * fastest_plate(scene_);
  if (step.kinetic > kSwing * put_in()) return Unsound{Unsound::Kind::energy, step.kinetic, put_in()};
  if (++steps_ % kStepsBetweenLooks != 0 && !look) return {};
  if (const double strain = strain_energy(s); strain > kSwing * put_in())
    return Unsound{Unsound::Kind::energy, step.kinetic + strain, put_in()};
  if (!s.has_water) return {};
  const double largest = largest_in(s);
  if (largest > largest_pressure()) return Unsound{Unsound::Kind::pressure, largest, largest_pressure()};
  return {};
}

template <int D>
void Soundness<D>::sampled(const State<D>& s) {
  pressures_ += largest_in(s);
  ++samples_;
}

double allowed_drift(const Scene& scene, const Ledger& ledger, double pressure) {
  double grains = 0;
  for (const auto& [name, soil] : scene.soils)
    grains = std::max(grains, ledger.solid_mass_initial / soil.grain_density);
  const double elastic = scene.water.bulk_modulus ? pressure / *scene.water.bulk_modulus : 0;
  return kMostDrift * (1 + grains / ledger.water_volume_initial) + elastic;
}

template <int D>
std::vector<std::string> Soundness<D>::cautions(const Ledger& l) const {
  const double drift = l.water_volume_drift;
  const double pressure = samples_ > 0 ? pressures_ / static_cast<double>(samples_) : 0;
  if (l.water_volume_initial <= 0 || std::abs(drift) <= allowed_drift(scene_, l, pressure)) return {};
  std::string said = "The water took " + text(100 * std::abs(drift)) + " % " +
                     (drift < 0 ? "less room than it should (points crowd)"
                                : "more room than it should (gaps between points count as filled)") +
                     ", as a mean over the second half of the run: levels and pressures are as far off. ";
  double duration = 0;
  for (const Stage& stage : scene_.stages) duration += stage.duration;
  if (scene_.numerics.drift_time == 0 || scene_.numerics.drift_time > 0.2 * duration)
    said += "numerics.drift_time of " + text(scene_.numerics.drift_time) +
            " s leaves that as it is: leave it out, or give a fraction of the run's time";
  else if (highest_head_ - scene_.domain.min[1] > 2 * diagonal_)
    said +=
        "The likely cause is a head of many times the scene's height, whose water crosses a cell within a "
        "step: lower it, let it rise more slowly (heads_ramp), or refine domain.cell_size";
  else
    said +=
        "The likely cause is water that strikes something or moves fast across a few cells: refine "
        "domain.cell_size by half; if that does not help, halve numerics.time_step_factor";
  return {said + "."};
}

template class Soundness<2>;
template class Soundness<3>;

}  // namespace quicksand

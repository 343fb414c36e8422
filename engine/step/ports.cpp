// Where water enters and leaves: reservoirs, seepage faces, open sides.
//
// A water point stands for a cube of the lattice, one spacing wide. While that cube reaches over an open port
// the point is a straddler: it carries the mass of the part inside and sits in the middle of that part, so
// that a uniform filling stays uniform while it passes. Straddlers come in when the flux through a port has
// brought more volume than points have carried (`owed`), and are gone when all of the cube is outside. All
// serial, in the order of the ports and points: the result does not depend on the number of threads.

#include <cmath>

#include "engine/step/phases.hpp"
#include "engine/step/step.hpp"

namespace quicksand {
namespace {

/// Pressure at a shut seepage face, in ρ g h, above which it opens: rounding of still water does not.
constexpr double kOpeningPressure = 1e-3;

template <int D>
double weight_of_water(const State<D>& s) {
  constexpr double kStandardGravity = 9.81;  // m/s², heads in scenes without gravity; as head_at
  double g2 = 0;
  for (double c : s.constants.gravity) g2 += c * c;
  return s.constants.water_density * (g2 > 0 ? std::sqrt(g2) : kStandardGravity);
}

template <int D>
int inner_cell(const State<D>& s, const Port<D>& port) {
  return port.inward > 0 ? port.face : port.face - s.grid.stride[port.d];
}

/// Whether a port above any level lets water out. Air inside: drops may leave. Water inside: only while it
/// flows out, or presses against the shut face.
template <int D>
bool seeps(const State<D>& s, const Port<D>& port) {
  const int cell = inner_cell(s, port);
  if (!s.cell[cell].wet()) return true;
  if (port.open) return port.inward * s.speeds[port.d][port.face].water <= 0;
  const double still = s.constants.water_density * s.constants.gravity[port.d] * port.inward;
  const double at_face = s.pressure[cell] - 0.5 * s.grid.h * still;
  return at_face > kOpeningPressure * weight_of_water(s) * s.grid.h;
}

template <int D>
double spacing(const State<D>& s) {
  return s.grid.h / s.constants.points_per_cell;
}
template <int D>
double share(const State<D>& s) {
  return s.grid.cell_volume() / power(s.constants.points_per_cell, D);
}
template <int D>
double plane_of(const State<D>& s, const Port<D>& port) {
  return s.grid.origin[port.d] + s.grid.cell(port.face)[port.d] * s.grid.h;
}

/// Passes water points through the ports of one step.
template <int D>
class WaterPass {
 public:
  WaterPass(State<D>& s, double dt, Exchange<D>& exchange) : s_(s), dt_(dt), exchange_(exchange) {}

  void run() {
    const std::vector<double> before = masses_in();
    count_flux();
    advance_straddlers();
    catch_crossing();
    remove_gone();
    find_straddlers();
    for (std::size_t k = 0; k < s_.ports.size(); ++k)
      if (s_.ports[k].submerged()) let_in(static_cast<int>(k));
    for (std::size_t r = 0; r < before.size(); ++r)
      s_.reservoirs[r].inflow = (s_.reservoirs[r].mass_in - before[r]) / (s_.constants.water_density * dt_);
  }

 private:
  std::vector<double> masses_in() const {
    std::vector<double> m;
    for (const ReservoirState& r : s_.reservoirs) m.push_back(r.mass_in);
    return m;
  }

  void count_flux() {
    for (Port<D>& port : s_.ports) {
      const double flux = s_.flow[port.d][port.face].n * s_.speeds[port.d][port.face].water;
      if (port.submerged())
        port.owed += dt_ * s_.grid.face_area() * s_.grid.face_radius(port.d, port.face) * port.inward * flux;
      else
        port.owed = 0;  // water only leaves
    }
  }

  /// Books a change of a point's mass that came through a port.
  void change_mass(std::uint32_t p, Port<D>& port, double mass) {
    const double change = mass - s_.water.mass[p];
    s_.water.mass[p] = mass;
    port.owed -= change / s_.constants.water_density;
    (change > 0 ? exchange_.water_in : exchange_.water_out) += std::abs(change);
    for (int d = 0; d < D; ++d) exchange_.momentum[d] += change * s_.water.v[p][d];
    if (port.reservoir >= 0) s_.reservoirs[port.reservoir].mass_in += change;
  }

  double place_of(const Port<D>& port, double depth) const {
    return plane_of(s_, port) + port.inward * spacing(s_) * 0.5 * (depth + 0.5);
  }
  void put(const Straddler& q) {
    const double inside = std::clamp(q.depth + 0.5, 0.0, 1.0);
    change_mass(q.point, s_.ports[q.port], inside * q.full_mass);
    s_.water.x[q.point][s_.ports[q.port].d] = place_of(s_.ports[q.port], q.depth);
  }

  /// Port through whose face x lies, seen along the axis of `port`, or −1.
  int port_across(const Port<D>& port, Vec<D> x) const {
    x[port.d] = s_.grid.center(s_.grid.cell(inner_cell(s_, port)))[port.d];
    const Cell<D> c = s_.grid.cell_of(x);
    const int face = s_.grid.index(c) + (port.inward > 0 ? 0 : s_.grid.stride[port.d]);
    const int found = s_.port_of[port.d][face] - 1;
    return found >= 0 && s_.ports[found].open ? found : -1;
  }

  /// Straddlers moved with the water; one that has slid off its port, or whose port has shut, is released
  /// with the mass that it has.
  void advance_straddlers() {
    std::erase_if(s_.straddlers, [&](Straddler& q) {
      const Port<D>& port = s_.ports[q.port];
      Vec<D>& x = s_.water.x[q.point];
      const int now = port_across(port, x);
      if (now < 0) {
        x[port.d] = plane_of(s_, port) +
                    port.inward * std::max(port.inward * (x[port.d] - plane_of(s_, port)), 1e-6 * s_.grid.h);
        return true;
      }
      q.depth += port.inward * (x[port.d] - place_of(port, q.depth)) / spacing(s_);
      q.port = now;
      if (q.depth >= 0.5) {
        const double overshoot = (q.depth - 0.5) * spacing(s_);
        q.depth = 0.5;
        put(q);
        x[port.d] += port.inward * overshoot;
        return true;
      }
      if (const int beside = left_through(port.d, x); beside >= 0) q.port = beside, q.depth = -0.5;
      if (q.depth > -0.5) put(q);
      return false;
    });
  }

  /// Open port that a straddler has passed along another axis than its own, around a corner of the domain, or
  /// −1. Where there is none it stays inside.
  int left_through(int own, Vec<D>& x) {
    const Cell<D> cell = s_.grid.cell_of(x);
    for (int d = 0; d < D; ++d) {
      const double low = s_.grid.origin[d], high = low + s_.grid.cells[d] * s_.grid.h;
      if (d == own || (x[d] >= low && x[d] <= high)) continue;
      const int k = s_.port_of[d][s_.grid.index(cell) + (x[d] > high ? s_.grid.stride[d] : 0)] - 1;
      if (k >= 0 && s_.ports[k].open) return k;
    }
    keep_inside(x, own);
    return -1;
  }

  /// Points that have come within half a spacing of an open port.
  void catch_crossing() {
    caught_.assign(s_.water.size(), 0);
    for (const Straddler& q : s_.straddlers) caught_[q.point] = 1;
    for (const int place : s_.port_blocks) {
      const PointRange points = s_.blocks.points(s_.water_blocks, s_.blocks.number_of(place));
      for (auto i = points.begin; i < points.end; ++i) catch_point(s_.water_blocks.order[i]);
    }
  }
  void catch_point(std::uint32_t p) {
    const int cell = s_.grid.index(s_.grid.cell_of(s_.water.x[p]));
    for (int d = 0; d < D; ++d)
      for (int side : {0, 1}) {
        const int k = s_.port_of[d][cell + side * s_.grid.stride[d]] - 1;
        if (k < 0 || caught_[p] || !s_.ports[k].open) continue;
        const Port<D>& port = s_.ports[k];
        const double depth = port.inward * (s_.water.x[p][d] - plane_of(s_, port)) / spacing(s_);
        if (depth >= 0.5 - kTouching) continue;
        s_.straddlers.push_back({p, k, std::max(depth, -0.5), s_.water.mass[p]});
        put(s_.straddlers.back());
        caught_[p] = 1;
      }
    if (!caught_[p]) keep_inside(s_.water.x[p], -1);
  }

  /// A point that went out through a port at an angle, to behind a wall or a shut one. Not along axis `own`.
  void keep_inside(Vec<D>& x, int own) {
    bool moved = false;
    for (int d = 0; d < D; ++d) {
      if (d == own) continue;
      const double low = s_.grid.origin[d], high = low + s_.grid.cells[d] * s_.grid.h;
      const double margin = 1e-6 * s_.grid.h;
      if (x[d] >= low && x[d] <= high) continue;
      x[d] = std::clamp(x[d], low + margin, high - margin);
      moved = true;
    }
    s_.interventions.clipped_points += moved;
  }

  void remove_gone() {
    for (std::size_t k = 0; k < s_.straddlers.size();) {
      Straddler& q = s_.straddlers[k];
      if (q.depth > -0.5) {
        ++k;
        continue;
      }
      change_mass(q.point, s_.ports[q.port], 0);
      const auto last = static_cast<std::uint32_t>(s_.water.size() - 1);
      erase_point(s_.water, q.point);
      for (Straddler& o : s_.straddlers)
        if (o.point == last) o.point = q.point;
      s_.straddlers.erase(s_.straddlers.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }

  /// Lane of a place on a port: its seeding row across the face.
  int lane_of(const Port<D>& port, const Vec<D>& x) const {
    const Vec<D> middle = s_.grid.center(s_.grid.cell(inner_cell(s_, port)));
    const int per_axis = s_.constants.points_per_cell;
    int lane = 0;
    for (int d = 0; d < D; ++d) {
      if (d == port.d) continue;
      const double t = (x[d] - middle[d]) * s_.grid.inverse_h + 0.5;
      lane = lane * per_axis + std::clamp(static_cast<int>(t * per_axis), 0, per_axis - 1);
    }
    return lane;
  }
  Vec<D> lane_place(const Port<D>& port, int lane) const {
    Vec<D> x = s_.grid.center(s_.grid.cell(inner_cell(s_, port)));
    const int per_axis = s_.constants.points_per_cell;
    for (int d = D - 1; d >= 0; --d) {
      if (d == port.d) continue;
      x[d] += ((lane % per_axis + 0.5) / per_axis - 0.5) * s_.grid.h;
      lane /= per_axis;
    }
    return x;
  }

  /// Which straddlers each port has.
  void find_straddlers() {
    first_.assign(s_.ports.size(), -1);
    next_.resize(s_.straddlers.size());
    for (int i = static_cast<int>(next_.size()) - 1; i >= 0; --i)
      next_[i] = std::exchange(first_[s_.straddlers[i].port], i);
  }

  /// Makes up for what the flux has brought in: new straddlers in lanes that have none, else those that are
  /// there come in a little further.
  void let_in(int k) {
    Port<D>& port = s_.ports[k];
    const FaceFlow& f = s_.flow[port.d][port.face];
    if (port.owed <= 0 || port.inward * s_.speeds[port.d][port.face].water <= 0) return;
    const int lanes = power(s_.constants.points_per_cell, D - 1);
    used_.assign(lanes, 0);
    int here = 0;
    for (int i = first_[k]; i >= 0; i = next_[i], ++here)
      used_[lane_of(port, s_.water.x[s_.straddlers[i].point])] = 1;
    const auto free = std::count(used_.begin(), used_.end(), 0);
    const double full = f.n * s_.constants.water_density * share(s_) * s_.grid.face_radius(port.d, port.face);
    const double mass = s_.constants.water_density * port.owed / static_cast<double>(free ? free : here);
    if (free) {
      for (int lane = 0; lane < lanes; ++lane)
        if (!used_[lane]) enter(k, lane, std::min(mass / full, 1.0) - 0.5, full);
    } else {
      for (int i = first_[k]; i >= 0; i = next_[i]) {
        Straddler& q = s_.straddlers[i];
        q.depth = std::min(q.depth + mass / q.full_mass, 0.5);
        put(q);
      }
    }
  }

  void enter(int k, int lane, double depth, double full_mass) {
    const Port<D>& port = s_.ports[k];
    const auto p = static_cast<std::uint32_t>(s_.water.size());
    Vec<D> x = lane_place(port, lane), v{};
    x[port.d] = place_of(port, depth);
    v[port.d] = s_.speeds[port.d][port.face].water;
    s_.water.add(x, v, 0, kInflowBody);
    s_.straddlers.push_back({p, k, depth, full_mass});
    put(s_.straddlers.back());
  }

  /// Spacings; points seeded half a spacing from a port stay whole.
  static constexpr double kTouching = 1e-9;

  State<D>& s_;
  const double dt_;
  Exchange<D>& exchange_;
  std::vector<char> caught_, used_;
  std::vector<int> first_, next_;  ///< straddlers: the first of a port, the one after; −1: none
};

/// Grains whose middle has passed an open side.
template <int D>
void lose_soil(State<D>& s, Exchange<D>& exchange) {
  for (std::size_t p = 0; p < s.soil.size();) {
    const Vec<D>& x = s.soil.x[p];
    bool gone = false;
    for (int d = 0; d < D; ++d)
      gone = gone || x[d] < s.grid.origin[d] || x[d] > s.grid.origin[d] + s.grid.cells[d] * s.grid.h;
    if (!gone) {
      ++p;
      continue;
    }
    exchange.soil_out += s.soil.mass[p];
    for (int d = 0; d < D; ++d) exchange.momentum[d] -= s.soil.mass[p] * s.soil.v[p][d];
    erase_point(s.soil, p);
  }
}

}  // namespace

template <int D>
void set_ports(State<D>& s) {
  const double weight = weight_of_water(s);
  for (Port<D>& port : s.ports) {
    const double level = port.reservoir < 0 ? port.elevation : s.reservoirs[port.reservoir].level(s.time);
    port.below_level = level > port.elevation;
    // The reservoir is still: what flows in has turned head into speed, p = γ (H − z) − ½ ρw v²; what flows
    // out loses its speed outside. Energy then never enters but with the water.
    const double inflow = std::max(0.0, port.inward * s.speeds[port.d][port.face].water);
    port.pressure =
        std::max(0.0, weight * (level - port.elevation) - 0.5 * s.constants.water_density * inflow * inflow);
    const bool open = port.submerged() || seeps(s, port);
    if (open != port.open) s.water_walls.set_port_open(port.d, port.face, open);
    port.open = open;
  }
}

template <int D>
void pass_ports(State<D>& s, StepReport<D>& report) {
  if (s.ports.empty()) return;
  WaterPass<D>(s, report.dt, report.exchange).run();
  const auto open_side = [](const Port<D>& port) { return port.reservoir < 0; };
  if (std::any_of(s.ports.begin(), s.ports.end(), open_side)) lose_soil(s, report.exchange);
  for (int d = 0; d < D; ++d) {
    report.exchange.momentum[d] *= s.constants.inertia;
    report.momentum[d] = s.momentum[d] += report.exchange.momentum[d];
  }
}

template void set_ports<2>(State<2>&);
template void set_ports<3>(State<3>&);
template void pass_ports<2>(State<2>&, StepReport<2>&);
template void pass_ports<3>(State<3>&, StepReport<3>&);

}  // namespace quicksand

// Velocities on the faces: momentum balance of both phases with the drag inside, contact of grains with
// walls, and correction by the pressure gradient.

#include "engine/step/damping.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/plain_faces.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {

template <int D>
double pressure_gradient(const State<D>& s, const Field<double>& inner, int d, int face) {
  const int low = face - s.grid.stride[d], high = face;
  const CellState &a = s.cell[low], &b = s.cell[high];
  if (s.water_walls.closed(d, face) || in_plate(s, d, face))
    return a.wet() || b.wet() ? s.constants.water_density * s.constants.gravity[d] : 0;
  const double inverse_h = s.grid.inverse_h;
  if (const Port<D>* port = port_at(s, d, face)) {
    const double inside = s.pressure[port->inward > 0 ? high : low];  // 0 in air
    return port->inward * (inside - port->pressure) * 2 * inverse_h;
  }
  if (a.wet() && b.wet()) return (inner[high] - inner[low]) * inverse_h;
  if (a.wet()) return -s.pressure[low] * inverse_h / surface_distance(a.depth, b.depth);
  if (b.wet()) return s.pressure[high] * inverse_h / surface_distance(b.depth, a.depth);
  return 0;
}

namespace {

/// Momentum balance of one face, per unit volume, before the pressure gradient.
struct Balance {
  double soil_mass = 0, soil_momentum = 0;  ///< kg/m³, × inertia; incl. dt × forces
  double water_mass = 0, water_momentum = 0;
  double drag = 0;        ///< dt × R on the grains, kg/m³
  double water_drag = 0;  ///< the same on the water; see below
  double fixed_drag = 0;  ///< dt × R of grains that do not move
};

/// All of a face while it is worked out.
struct FaceTrial : FaceFlow, FaceRest, FaceSpeeds {
  double slip = 0, slip_response = 0;  ///< of the water past the grains, as the velocities
};

/// Implicit drag: [FMS19] eqs. (1) and (2) as one 2×2 system, solved for v̂ and for the response to G.
/// The water's inertia is that of a full face, but its points carry only the mass that is there, a few per
/// cent more or less; `water_drag` is scaled so that points of both phases exchange exactly one impulse.
void solve_pair(const Balance& b, double dt, FaceTrial& f) {
  const double a11 = b.soil_mass + b.drag, a12 = -b.drag;
  const double a22 = b.water_mass + b.water_drag + b.fixed_drag, a21 = -b.water_drag;
  // a11 a22 − a12 a21 without its products of two drags, which cancel: at 10⁻¹⁴ m/s nothing else would be
  // left.
  const double free = b.water_mass + b.fixed_drag, det = b.soil_mass * a22 + b.drag * free;
  const double inverse = 1 / det, per_gradient = dt * inverse;
  f.soil = (a22 * b.soil_momentum - a12 * b.water_momentum) * inverse;
  f.water = (a11 * b.water_momentum - a21 * b.soil_momentum) * inverse;
  f.soil_response = (a22 * f.pushed - a12 * f.n) * per_gradient;
  f.water_response = (a11 * f.n - a21 * f.pushed) * per_gradient;
  f.slip = (b.soil_mass * b.water_momentum - free * b.soil_momentum) * inverse;
  f.slip_response = (b.soil_mass * f.n - free * f.pushed) * per_gradient;
}

/// Water past grains that are held.
void solve_water(const Balance& b, double dt, FaceTrial& f) {
  const double inverse = 1 / (b.water_mass + b.water_drag + b.fixed_drag);
  f.soil = f.soil_response = 0;
  f.water = f.slip = b.water_momentum * inverse;
  f.water_response = f.slip_response = dt * f.n * inverse;
}

void solve_soil(const Balance& b, double dt, FaceTrial& f) {
  f.soil = b.soil_momentum / b.soil_mass;
  f.soil_response = dt * f.pushed / b.soil_mass;
  f.water = f.water_response = 0;
}

/// v̂ and responses of what is there: water, and grains if they move.
void solve(const Balance& b, double dt, bool moving_soil, FaceTrial& f) {
  if (b.water_mass > 0 && moving_soil)
    solve_pair(b, dt, f);
  else if (b.water_mass > 0)
    solve_water(b, dt, f);
  else if (moving_soil)
    solve_soil(b, dt, f);
}

/// Inertia with which each phase is damped, from what it would do in this step under the last pressure.
template <int D>
void damp(const State<D>& s, int d, int face, double dt, bool moving_soil, Balance& b, FaceTrial& f) {
  FaceTrial trial = f;
  solve(b, dt, moving_soil, trial);
  const double alpha = s.constants.damping;
  if (moving_soil) {
    const double change = trial.soil - trial.soil_response * gradient_on_grains(s, d, face) - f.soil_old;
    f.soil_inertia = 1 / damped_part(alpha, f.soil_old, change);
    b.soil_momentum += (f.soil_inertia - 1) * b.soil_mass * f.soil_old;
    b.soil_mass *= f.soil_inertia;
  }
  if (b.water_mass > 0) {
    const double g = f.wet ? pressure_gradient(s, d, face) : 0,
                 change = trial.water - trial.water_response * g - f.water_old;
    f.water_inertia = 1 / damped_part(alpha, f.water_old, change);
    b.water_momentum += (f.water_inertia - 1) * b.water_mass * f.water_old;
    b.water_mass *= f.water_inertia;
  }
}

/// +1 or −1: the direction in which grains may leave a closed face; 0: neither (walls of no thickness,
/// which may have grains on both sides; planes of symmetry).
template <int D>
int leaving_direction(const State<D>& s, int d, int face) {
  if (s.soil_walls.symmetry(d, face)) return 0;
  const bool low = s.soil_walls.blocked(face - s.grid.stride[d]), high = s.soil_walls.blocked(face);
  return low == high ? 0 : low ? 1 : -1;
}

/// What soil and water take of a face's volume, –.
struct Taken {
  double bulk = 0, fill = 0;  ///< soil with its pores; what lies below the water surface
};
template <int D>
Taken taken(const State<D>& s, int d, int face) {
  const FaceSums f = s.sums[d][face];
  const double volume = s.volume.face(d, face);
  const FixedFace fixed = s.fixed.size() ? s.fixed_face[d][face] : FixedFace{};
  const double grains = f.grains / volume + fixed.phi, bulk = f.soil_bulk / volume + fixed.bulk;
  return {bulk, fill_of(f.water_mass / (s.constants.water_density * volume), grains, bulk)};
}

/// Part of a face's volume that lies inside, where a reservoir begins at the face.
constexpr double kInsidePort = 0.5;

/// Part of a wet face's volume that is soil or below the water surface; 1 where its kernel, 1½ cells long,
/// does not reach the surface. At a reservoir it is the inner half, however unevenly its points lie.
template <int D>
double wet_part(const State<D>& s, int d, int face) {
  const int step = s.grid.stride[d];
  const auto dry = [&](int from, int to, int between) {
    return s.cell[from].wet() && !s.cell[to].wet() && !s.water_walls.closed(d, between) &&
           !submerged(s, d, between);
  };
  const bool inside = s.cell[face].wet() && s.cell[face - step].wet();
  if (inside && !dry(face, face + step, face + step) && !dry(face - step, face - 2 * step, face - step))
    return 1;
  const Taken t = taken(s, d, face);
  const double fill = submerged(s, d, face) ? kInsidePort : t.fill;
  return std::clamp(std::max(fill, t.bulk), kLeastWetPart, 1.0);
}

/// A face between air cells, next to the face at the water surface: what kernels reach there of the soil
/// below the surface feels the pressure as that face does. Without it a saturated layer drains 1/48 of a cell
/// above its top. Returns the part of the face's volume that soil and water take; 0 for other faces.
template <int D>
double soak(const State<D>& s, int d, int face, FaceTrial& f) {
  const int step = s.grid.stride[d];
  for (const int side : {-1, 1}) {
    const int next = face + side * step, wet_cell = side < 0 ? face - 2 * step : next;
    if (!s.cell[wet_cell].wet() || s.water_walls.closed(d, next) || in_plate(s, d, next)) continue;
    const Taken t = taken(s, d, face);
    if (t.bulk <= 0 || t.fill <= 0) return 0;
    f.soaked = std::min(1.0, t.fill / t.bulk);
    f.soaked_side = static_cast<std::int8_t>(side);
    return std::max(t.fill, t.bulk);
  }
  return 0;
}

/// Moving grains beside fixed ones: a face's gradient is the mean over both, but each part loses head by its
/// own resistance, E_m = ρ_m q. With the drag n E A_m/(A_m + A_f), A resistivity × bulk, the moving part gets
/// its whole A_m q if the pressure pushes this much of it.
double pushed_part(double phi, double resistivity, double fixed_phi, double fixed_resistivity) {
  if (fixed_resistivity <= 0) return phi;
  return (phi + fixed_phi) * resistivity / (resistivity + fixed_resistivity);
}

template <class P, int D>
FaceTrial predicted(State<D>& s, int d, int face, double dt) {
  const FaceSums sums = s.sums[d][face];
  FaceTrial f;
  const double volume = s.volume.face(d, face), rho = s.constants.water_density;
  const double inertia = s.constants.inertia, fall = s.constants.fall(d);
  const bool soil = P::soil && sums.soil_mass > kMassCutoff * rho * volume;
  const bool water_open = P::water && !s.water_walls.closed(d, face);
  const bool water = water_open && sums.water_mass > kMassCutoff * rho * volume;
  const bool soil_closed = s.soil_walls.closed(d, face);
  const bool wet =
      water_open && (s.cell[face].wet() || s.cell[face - s.grid.stride[d]].wet() || submerged(s, d, face));
  f.wet = wet;
  if (!soil && !water && !wet) {
    if (soil_closed) s.soil_walls.set_separated(d, face, false);
    return f;
  }

  // A face at the water surface stands for the wet part of its volume: what half a face of saturated soil
  // holds is dense over that half, and the pressure falls over that half only.
  const double soaked = soil && water && !wet ? soak(s, d, face, f) : 0;
  const double part = wet ? wet_part(s, d, face) : soaked > 0 ? soaked : 1;
  const double per_volume = 1 / (part * volume);
  Balance b;
  f.phi = sums.grains * per_volume;
  double fixed_phi = 0, fixed_resistivity = 0;
  if (P::soil && s.fixed.size()) {
    fixed_phi = s.fixed_face[d][face].phi / part;
    fixed_resistivity = s.fixed_face[d][face].resistivity / part;
  }
  f.n = std::max(1 - f.phi - fixed_phi, kMinRoom);
  f.pushed = f.phi;
  if (wet) f.pushed = pushed_part(f.phi, sums.resistivity * per_volume, fixed_phi, fixed_resistivity);
  if (soil) {
    f.soil_old = sums.soil_momentum / sums.soil_mass;
    b.soil_mass = inertia * sums.soil_mass * per_volume;
    b.soil_momentum = b.soil_mass * (f.soil_old + dt * fall) + dt * sums.soil_force * per_volume;
    if (wet) b.soil_momentum -= dt * (f.phi - f.pushed) * rho * s.constants.gravity[d];
  }
  if (water || wet) {
    // Inertia of a wet face is that of a full one, n ρw, not of the few drops whose kernels reach it; where
    // there is no pressure, drops carry and are dragged by what is there.
    const double full = f.n * rho;
    const double there = wet ? 1 : std::min(1.0, sums.water_mass * per_volume / full);
    f.water_old = water ? sums.water_momentum / sums.water_mass : 0;
    b.water_mass = inertia * there * full;
    f.viscous = water && s.constants.viscosity > 0 ? viscous_acceleration(s, d, face) : 0;
    b.water_momentum = b.water_mass * (f.water_old + dt * (fall + f.viscous / inertia));
    if (soil) b.drag = dt * there * f.n * f.n * sums.resistivity * per_volume;
    const double share = wet ? sums.water_mass * per_volume / full : 1;
    b.water_drag = b.drag / std::max(share, kLeastWetPart);
    b.drag = share * b.water_drag;  // less on the grains, too, where next to no water is
    f.fixed_drag = f.n * f.n * fixed_resistivity;
    b.fixed_drag = dt * there * f.fixed_drag;
  }

  bool held = false;
  if (soil && soil_closed) {
    // Contact, one-sided: grains stay on the wall while what acts on them, with the last pressure
    // gradient, presses them to it.
    FaceTrial trial = f;
    solve(b, dt, true, trial);
    const double leaving = trial.soil - trial.soil_response * pressure_gradient(s, d, face);
    held = !(leaving * leaving_direction(s, d, face) > 0);
  }
  if (soil_closed) s.soil_walls.set_separated(d, face, soil && !held);
  const bool moving_soil = soil && !held;
  if (s.constants.damping > 0) {
    s.flow[d][face] = f;  // for the gradient that the grains feel
    s.rest[d][face] = f;
    damp(s, d, face, dt, moving_soil, b, f);
  }
  solve(b, dt, moving_soil, f);
  f.exchange = b.drag * part * f.slip;
  f.exchange_response = b.drag * part * f.slip_response;
  if (!water_open) f.water = f.water_response = 0;
  return f;
}

}  // namespace

template <int D>
void predict_velocities(State<D>& s, double dt) {
  const bool keeps_flow = s.keeps_flow(), keeps_rest = s.keeps_rest();
  with_phases(s, [&](auto phases) {
    using P = decltype(phases);
    s.blocks.all([&](int b) {
      if (s.plain[b]) {
        predict_plain<P>(s, b, dt);
        return;
      }
      s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
        for (int d = 0; d < D; ++d) {
          const FaceTrial f = predicted<P>(s, d, face, dt);
          s.speeds[d][face] = f;
          if (keeps_flow) s.flow[d][face] = f;
          if (keeps_rest || f.soaked_side) s.rest[d][face] = f;
          if (P::water && f.wet) {
            s.flux[d][face] = f.flux(f);
            s.flux_response[d][face] = f.flux_response();
          }
        }
      });
    });
  });
}

template <int D>
void correct_velocities(State<D>& s) {
  std::vector<std::uint8_t> beyond(
      s.blocks.count());  // per block, whether water is on faces without pressure
  with_phases(s, [&](auto phases) {
    using P = decltype(phases);
    s.blocks.all([&](int b) {
      if (s.plain[b]) {
        correct_plain<P>(s, b);
        return;
      }
      s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
        for (int d = 0; d < D; ++d) {
          FaceSpeeds& v = s.speeds[d][face];
          if constexpr (P::water) {
            FaceFlow& f = s.flow[d][face];
            const double g = gradient_on_grains(s, d, face);
            if (!f.wet && may_be_extended(s, d, face)) beyond[b] = 1;
            if (f.wet || f.soaked_side) v.water -= f.water_response * g;
            if constexpr (P::soil) {
              v.soil -= f.soil_response * g;
              f.exchange -= f.exchange_response * g;
            }
          }
          if (P::soil && s.soil_walls.closed(d, face) && v.soil * leaving_direction(s, d, face) <= 0)
            v.soil = 0;
        }
      });
    });
  });
  if (s.constants.kernel == Kernel::linear) follow_leaders(s);
  if (s.has_water) extend_water(s, beyond);
}

template double pressure_gradient<2>(const State<2>&, const Field<double>&, int, int);
template double pressure_gradient<3>(const State<3>&, const Field<double>&, int, int);
template void predict_velocities<2>(State<2>&, double);
template void predict_velocities<3>(State<3>&, double);
template void correct_velocities<2>(State<2>&);
template void correct_velocities<3>(State<3>&);

}  // namespace quicksand

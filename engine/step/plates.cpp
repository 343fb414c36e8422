// Rigid plates on soil.
//
// A plate is a row of faces whose grains and water move as one. It has no mass of its own. With M the mass of
// the row, the pressure p of the cells beside the row acting on its area, and F the force on it (or unknown,
// if the speed V is given),
//   M V = Σ m v + Δt (Σ f + W + F + Σ b p),   b = ± area of a face (times the radius about an axis),
// which the pressure solve takes in as one rank-1 term: V = V̂ + Δt/M Σ b p. Water does not pass: the flux
// through the row is V. A plate pushes and never pulls. How kernels mirror at it: plate_mirrors.cpp.
//
// Other faces balance weight and pressure per volume; the row does as a whole. So that water at rest stays
// so, its weight W is that of what is there beyond the water's buoyancy, and of the water in half a cell on
// each wet side.

#include <cmath>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

constexpr int kAlong = kPlateAxis;
template <int D>
double area(const State<D>& s, int face) {
  return s.grid.face_area() * s.grid.face_radius(kAlong, face);
}

/// Σ b p over the cells beside the row, N upward.
template <int D>
double push(const State<D>& s, const Plate<D>& plate, const Field<double>& pressure) {
  double sum = 0;
  for (int face : plate.row) {
    const int below = face - s.grid.stride[kAlong];
    if (s.cell[below].wet()) sum += area(s, face) * pressure[below];
    if (s.cell[face].wet()) sum -= area(s, face) * pressure[face];
  }
  return sum;
}

template <int D>
void hold_row(State<D>& s, const Plate<D>& plate) {
  for (int face : plate.row) {
    FaceFlow& f = s.flow[kAlong][face];
    s.speeds[kAlong][face].soil = s.speeds[kAlong][face].water = plate.speed;
    f.soil_response = f.water_response = 0;
    s.flux[kAlong][face] = f.flux(s.speeds[kAlong][face]);
    s.flux_response[kAlong][face] = 0;
    f.exchange = f.exchange_response = f.viscous = 0;
    if (!s.keeps_rest()) continue;
    FaceRest& rest = s.rest[kAlong][face];
    rest.fixed_drag = 0;
    rest.soil_inertia = rest.water_inertia = 1;  // what a plate holds moves as the plate does, undamped
  }
}

/// Weight (N, upward) of what is at a face of a row.
template <int D>
double weight(const State<D>& s, int face) {
  const FaceSums sums = s.sums[kAlong][face];
  const bool below = s.cell[face - s.grid.stride[kAlong]].wet(), above = s.cell[face].wet();
  const double rho = s.constants.water_density;
  double mass = sums.soil_mass + sums.water_mass;
  if (below) mass -= rho * sums.grains;
  if (below || above) mass -= sums.water_mass;
  mass += rho * (below + above) * 0.5 * s.grid.h * area(s, face);
  return mass * s.constants.gravity[kAlong];
}

/// Mass (kg), momentum (N·s), both × inertia, and forces (N), without the pressure's, on a plate's row.
struct Carried {
  double mass = 0, momentum = 0, force = 0;
};
template <int D>
Carried carried(const State<D>& s, const Plate<D>& plate) {
  Carried c;
  for (int face : plate.row) {
    const FaceSums sums = s.sums[kAlong][face];
    c.mass += s.constants.inertia * (sums.soil_mass + sums.water_mass);
    c.momentum += s.constants.inertia * (sums.soil_momentum + sums.water_momentum);
    c.force += sums.soil_force + weight(s, face);
  }
  return c;
}

}  // namespace

template <int D>
void press_plates(State<D>& s, double dt) {
  s.pressure_system.pistons.clear();
  for (Plate<D>& plate : s.plates) {
    if (!plate.active) continue;
    const Carried c = carried(s, plate);
    plate.mass = c.mass;
    if (plate.mass <= kMassCutoff * s.constants.water_density * s.grid.cell_volume()) {
      plate.touches = false;
      continue;
    }
    plate.speed = (c.momentum + dt * (c.force + plate.rise(s.time) * plate.force)) / plate.mass;
    plate.touches = true;
    if (plate.driven) {
      const double given = plate.rise(s.time) * plate.velocity[kAlong];
      plate.reaction = plate.mass * (given - plate.speed) / dt;  // less the pressure, below
      plate.touches = plate.reaction - push(s, plate, s.pressure) <= 0;
      plate.speed = given;
    }
    if (!plate.touches) continue;
    hold_row(s, plate);
    if (plate.driven) continue;
    // Rows of the system are balances per area of a face: h^(D−1) of the force over h of the divergence.
    typename PressureSystem<D>::Piston piston;
    piston.response = dt / plate.mass * (D == 2 ? 1 : s.grid.h);
    const auto add = [&](int cell, double weight) {
      if (!s.cell[cell].wet()) return;
      piston.cell.push_back(cell);
      piston.weight.push_back(weight);
    };
    for (int face : plate.row) {
      add(face - s.grid.stride[kAlong], s.grid.face_radius(kAlong, face));
      add(face, -s.grid.face_radius(kAlong, face));
    }
    s.pressure_system.pistons.push_back(std::move(piston));
  }
}

template <int D>
void settle_plates(State<D>& s, double dt) {
  const Field<double>& pressure = s.constants.explicit_pressure ? s.pressure_old : s.pressure;
  for (Plate<D>& plate : s.plates) {
    if (!plate.active || !plate.touches) continue;
    const double pushed = push(s, plate, pressure);
    if (plate.driven) {
      plate.reaction -= pushed;
    } else {
      plate.reaction = plate.rise(s.time) * plate.force;
      plate.speed += dt / plate.mass * pushed;
    }
    hold_row(s, plate);
  }
}

template <int D>
void move_plates(State<D>& s, double dt) {
  for (Plate<D>& plate : s.plates) {
    if (!plate.active) continue;
    if (!plate.touches) {
      plate.reaction = 0;
      plate.speed = plate.driven ? plate.rise(s.time) * plate.velocity[kAlong] : 0;
    }
    s.load_force[kAlong] += plate.reaction;
    const double before = plate.sunk;
    plate.sunk += dt * plate.speed;
    if (std::lround(before * s.grid.inverse_h) != std::lround(plate.sunk * s.grid.inverse_h))
      s.plates_left_rows = true;
  }
  unfold_plates(s);
}

template void press_plates<2>(State<2>&, double);
template void press_plates<3>(State<3>&, double);
template void settle_plates<2>(State<2>&, double);
template void settle_plates<3>(State<3>&, double);
template void move_plates<2>(State<2>&, double);
template void move_plates<3>(State<3>&, double);

}  // namespace quicksand

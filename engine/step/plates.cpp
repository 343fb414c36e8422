// Rigid plates on soil.
//
// A plate is a row of faces whose grains and water move as one. It has no mass of its own. With M the mass of
// the row, the pressure p of the cells beside the row acting on its area, and F the force on it (or unknown,
// if the speed V is given),
//   M V = Σ m v + Δt (Σ f + M g + F + Σ b p),   b = ± area of a face (times the radius about an axis),
// which the pressure solve takes in as one rank-1 term: V = V̂ + Δt/M Σ b p. Water does not pass: the flux
// through the row is V. A plate pushes and never pulls. Its upper side is dry.
//
// Kernels of the ground below reach over the row. What they leave there is mirrored relative to the plate, as
// at a wall: v_above = 2V − v_below. So the face below takes over the mass M′ and minus the force f′ of the
// one above, and the row 2M′ and 2f′. A rough plate does the same with the grains' sliding components; what
// slides freely goes to the face below as it is: left above, it would move without the pressure below. Water
// stays where there is free water above the plate, as no one knows then from which side it came.

#include <algorithm>
#include <cmath>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

constexpr int kAlong = kPlateAxis;
template <int D>
double rise(const State<D>& s, const Plate<D>& plate) {
  return plate.ramp > 0 ? std::clamp((s.time - plate.start) / plate.ramp, 0.0, 1.0) : 1;
}

template <int D>
double area(const State<D>& s, int face) {
  return s.grid.face_area() * s.grid.face_radius(kAlong, face);
}

/// Σ b p over the cells beside the row, N upward.
template <int D>
double push(const State<D>& s, const Plate<D>& plate, const std::vector<double>& pressure) {
  double sum = 0;
  for (int face : plate.row) {
    const int below = face - s.grid.stride[kAlong];
    if (s.cell[below].unknown >= 0) sum += area(s, face) * pressure[below];
    if (s.cell[face].unknown >= 0) sum -= area(s, face) * pressure[face];
  }
  return sum;
}

template <int D>
void hold_row(State<D>& s, const Plate<D>& plate) {
  for (int face : plate.row) {
    FaceFlow& f = s.flow[kAlong][face];
    f.soil = f.water = plate.speed;
    f.soil_response = f.water_response = 0;
    f.drag = f.fixed_drag = f.viscous = 0;
    f.soil_inertia = f.water_inertia = 1;  // what a plate holds moves as the plate does, undamped
  }
}

/// Mass (kg), momentum (N·s), both × inertia, and stress force (N) of a plate's row.
struct Carried {
  double mass = 0, momentum = 0, force = 0;
};
template <int D>
Carried carried(const State<D>& s, const Plate<D>& plate) {
  Carried c;
  for (int face : plate.row) {
    const FaceSums& sums = s.sums[kAlong][face];
    c.mass += s.constants.inertia * (sums.soil_mass + sums.water_mass);
    c.momentum += s.constants.inertia * (sums.soil_momentum + sums.water_momentum);
    c.force += sums.soil_force;
  }
  return c;
}

/// Folds the grains of the face `outer` beyond the plane back on `inner`: `sign` −1 mirrors their velocity
/// relative to the plate's, `speed` along d; +1 leaves it.
template <int D>
void fold_grains(State<D>& s, int d, int inner, int outer, double sign, double speed) {
  FaceSums &in = s.sums[d][inner], &out = s.sums[d][outer];
  in.soil_momentum += sign * out.soil_momentum + (1 - sign) * speed * out.soil_mass;
  in.soil_force += sign * out.soil_force;
  in.soil_mass += out.soil_mass;
  in.grains += out.grains;
  in.soil_bulk += out.soil_bulk;
  in.resistivity += out.resistivity;
  s.image[d][inner].soil += (1 - sign) * out.soil_mass + sign * s.image[d][outer].soil;
  const double water_mass = out.water_mass, water_momentum = out.water_momentum;
  out = {};
  out.water_mass = water_mass;
  out.water_momentum = water_momentum;
}

template <int D>
void fold_water(State<D>& s, int d, int inner, int outer, double sign, double speed) {
  FaceSums &in = s.sums[d][inner], &out = s.sums[d][outer];
  in.water_momentum += sign * out.water_momentum + (1 - sign) * speed * out.water_mass;
  in.water_mass += out.water_mass;
  s.image[d][inner].water += (1 - sign) * out.water_mass + sign * s.image[d][outer].water;
  out.water_mass = out.water_momentum = 0;
}

/// Whether the face of component d, with its middle above the plane, has no free water beside it.
template <int D>
bool dry(const State<D>& s, int d, int face) {
  return s.cell[face].unknown < 0 && (d == kAlong || s.cell[face - s.grid.stride[d]].unknown < 0);
}

/// The cell above a row holds what kernels of the ground below leave there, unless it is wet by itself.
template <int D>
void fold_cell(State<D>& s, int above) {
  if (s.cell[above].unknown >= 0) return;
  CellSums &in = s.cell_sums[above - s.grid.stride[kAlong]], &out = s.cell_sums[above];
  in.water += out.water;
  in.grains += out.grains;
  in.soil_bulk += out.soil_bulk;
  out = {};
}

template <int D>
double sliding(const State<D>& s, const Plate<D>& plate, int d) {
  return rise(s, plate) * plate.velocity[d];
}

}  // namespace

template <int D>
void fold_plates(State<D>& s) {
  // Not when they move: until the step's end its ledger asks which faces they hold.
  if (std::any_of(s.plates.begin(), s.plates.end(), [&](const Plate<D>& plate) {
        return plate.active && plate.row_number != std::lround(plate.sunk * s.grid.inverse_h);
      }))
    mark_plates(s);
  for (Plate<D>& plate : s.plates) {
    if (!plate.active || !plate.touches) continue;
    const int up = s.grid.stride[kAlong];
    for (int face : plate.row) {
      FaceSums &row = s.sums[kAlong][face], &out = s.sums[kAlong][face + up];
      FaceImage &held = s.image[kAlong][face], &beyond = s.image[kAlong][face + up];
      row.soil_mass += 2 * out.soil_mass;
      row.soil_momentum += 2 * out.soil_mass * plate.speed;
      row.soil_force += 2 * out.soil_force;
      held.soil += 2 * beyond.soil;
      fold_grains(s, kAlong, face - up, face + up, -1, plate.speed);
      if (dry(s, kAlong, face)) {
        row.water_mass += 2 * out.water_mass;
        row.water_momentum += 2 * out.water_mass * plate.speed;
        held.water += 2 * beyond.water;
        fold_water(s, kAlong, face - up, face + up, -1, plate.speed);
      }
      fold_cell(s, face);
    }
    for (const auto& [d, inner] : plate.beside) {
      fold_grains(s, d, inner, inner + up, plate.rough ? -1 : 1, sliding(s, plate, d));
      if (dry(s, d, inner + up)) fold_water(s, d, inner, inner + up, 1, 0);
    }
  }
}

template <int D>
void press_plates(State<D>& s, double dt) {
  s.pressure_system.pistons.clear();
  for (Plate<D>& plate : s.plates) {
    if (!plate.active) continue;
    const Carried c = carried(s, plate);
    plate.mass = c.mass;
    const double gravity = s.constants.fall(kAlong), load = rise(s, plate) * plate.force;
    if (plate.mass <= kMassCutoff * s.constants.water_density * s.grid.cell_volume()) {
      plate.touches = false;
      continue;
    }
    plate.speed = (c.momentum + dt * (c.force + load)) / plate.mass + dt * gravity;
    plate.touches = true;
    if (plate.driven) {
      const double given = rise(s, plate) * plate.velocity[kAlong];
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
      if (s.cell[cell].unknown < 0) return;
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
  const std::vector<double>& pressure = s.constants.explicit_pressure ? s.pressure_old : s.pressure;
  for (Plate<D>& plate : s.plates) {
    if (!plate.active || !plate.touches) continue;
    const double pushed = push(s, plate, pressure);
    if (plate.driven) {
      plate.reaction -= pushed;
    } else {
      plate.reaction = rise(s, plate) * plate.force;
      plate.speed += dt / plate.mass * pushed;
    }
    hold_row(s, plate);
  }
}

namespace {

/// Velocities beyond the plane, for the points whose kernels reach there: as they were folded.
template <int D>
void unfold(State<D>& s, const Plate<D>& plate) {
  const int up = s.grid.stride[kAlong];
  for (int face : plate.row) {
    const FaceFlow &in = s.flow[kAlong][face - up], &row = s.flow[kAlong][face];
    FaceFlow& out = s.flow[kAlong][face + up];
    out.soil_old = 2 * row.soil_old - in.soil_old;
    out.soil = 2 * plate.speed - in.soil;
    if (!dry(s, kAlong, face)) continue;
    out.water_old = 2 * row.water_old - in.water_old;
    out.water = 2 * plate.speed - in.water;
  }
  for (const auto& [d, inner] : plate.beside) {
    const FaceFlow& in = s.flow[d][inner];
    FaceFlow& out = s.flow[d][inner + up];
    const double twice = plate.rough ? 2 * sliding(s, plate, d) : 0, sign = plate.rough ? -1 : 1;
    out.soil_old = twice + sign * in.soil_old;
    out.soil = twice + sign * in.soil;
    if (dry(s, d, inner + up)) out.water_old = in.water_old, out.water = in.water, out.wet = in.wet;
  }
}

}  // namespace

template <int D>
void move_plates(State<D>& s, double dt) {
  for (Plate<D>& plate : s.plates) {
    if (!plate.active) continue;
    if (!plate.touches) {
      plate.reaction = 0;
      plate.speed = plate.driven ? rise(s, plate) * plate.velocity[kAlong] : 0;
    }
    s.load_force[kAlong] += plate.reaction;
    if (plate.touches) unfold(s, plate);
    plate.sunk += dt * plate.speed;
  }
}

namespace {

/// No soil below the cell `above` the plane.
template <int D>
bool bare(const State<D>& s, int above) {
  const int below = above - s.grid.stride[kAlong];
  return s.cell_sums[below].soil_bulk < 0.5 * s.volume.cell(below);
}

/// Faces of the sliding components just below the row: those between its cells, and at its ends where the
/// soil ends too or sticks to the plate's edge.
template <int D>
void mark_beside(const State<D>& s, Plate<D>& plate, std::int32_t mark) {
  for (int i : plate.row)
    for (int d = 0; d < D; ++d) {
      if (d == kAlong) continue;
      const int up = s.grid.stride[kAlong], before = i - s.grid.stride[d], after = i + s.grid.stride[d];
      if (s.plate_of[before] == mark || plate.rough || bare(s, before)) plate.beside.emplace_back(d, i - up);
      if (s.plate_of[after] != mark && (plate.rough || bare(s, after)))
        plate.beside.emplace_back(d, after - up);
    }
}

}  // namespace

template <int D>
void mark_plates(State<D>& s) {
  if (s.plates.empty()) return;
  for (Plate<D>& plate : s.plates) plate.row_number = std::lround(plate.sunk * s.grid.inverse_h);
  s.plate_of.assign(s.grid.count(), 0);
  for (std::size_t k = 0; k < s.plates.size(); ++k) {
    Plate<D>& plate = s.plates[k];
    plate.row.clear(), plate.beside.clear();
    if (!plate.active) continue;
    for_each_cell(s.grid, [&](int i, const Cell<D>& c) {
      const Vec<D> x = s.grid.center(c);
      // Rows from the plate's plane, the cell being the one above it.
      const long rows = std::lround((x[kAlong] - plate.low[kAlong] - plate.sunk) * s.grid.inverse_h - 0.5);
      if (rows != 0) return;
      // Where the soil ends with the plate, kernels reach one column beyond; that belongs to the plate too.
      const double beyond = bare(s, i) ? s.grid.h : 0;
      bool inside = true;
      for (int d = 0; d < D; ++d)
        if (d != kAlong) inside = inside && x[d] > plate.low[d] - beyond && x[d] < plate.high[d] + beyond;
      if (!inside) return;
      plate.row.push_back(i);
      s.plate_of[i] = static_cast<std::int32_t>(k + 1);
    });
    mark_beside(s, plate, static_cast<std::int32_t>(k + 1));
  }
}

template void fold_plates<2>(State<2>&);
template void fold_plates<3>(State<3>&);
template void press_plates<2>(State<2>&, double);
template void press_plates<3>(State<3>&, double);
template void settle_plates<2>(State<2>&, double);
template void settle_plates<3>(State<3>&, double);
template void move_plates<2>(State<2>&, double);
template void move_plates<3>(State<3>&, double);
template void mark_plates<2>(State<2>&);
template void mark_plates<3>(State<3>&);

}  // namespace quicksand

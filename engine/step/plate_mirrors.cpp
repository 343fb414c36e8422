// Where plates are, and how kernels mirror at them.
//
// Kernels reach over a plate's row. What they leave there is mirrored relative to the plate, as at a wall:
// v_above = 2V − v_below. So the face below takes over the mass M′ and minus the force f′ of the one above,
// and the row 2M′ and 2f′. A rough plate does the same with the grains' sliding components; what slides
// freely goes to the face below as it is: left above, it would move without the pressure below. Grains are
// below a plate only, so that their faces can be folded once they are summed; water may be on both sides, and
// its kernels see the row as a mirror (grid/walls.hpp), with the velocities behind it on ghosts.

#include <cmath>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

constexpr int kAlong = kPlateAxis;

/// Folds the grains of the face `outer` beyond the plane back on `inner`: `sign` −1 mirrors their velocity
/// relative to the plate's, `speed` along d; +1 leaves it.
template <int D>
void fold_grains(State<D>& s, int d, int inner, int outer, double sign, double speed) {
  FaceSums in = s.sums[d][inner];
  const FaceSums out = s.sums[d][outer];
  in.soil_momentum += sign * out.soil_momentum + (1 - sign) * speed * out.soil_mass;
  in.soil_force += sign * out.soil_force;
  in.soil_mass += out.soil_mass;
  in.grains += out.grains;
  in.soil_bulk += out.soil_bulk;
  in.resistivity += out.resistivity;
  s.image[d][inner].soil += (1 - sign) * out.soil_mass + sign * s.image[d][outer].soil;
  s.sums[d].set_soil(inner, in);
  s.sums[d].set_soil(outer, {});
}

/// The face behind a ghost's mirror.
int behind(const Ghost& ghost) { return 2 * ghost.carried - ghost.inner; }

/// Folds the water of ghosts: mirrored at a plate that touches, or left to the faces behind one that is
/// lifted.
template <int D>
void fold_ghosts(State<D>& s) {
  if (!s.has_water) return;
  const auto& ghosts = s.water_walls.ghosts(kAlong);
  for (std::size_t k = 0; k < ghosts.size(); ++k) {
    MassSum& out = s.sums[kAlong].water[s.grid.count() + k];
    FaceImage& image = s.image[kAlong][s.grid.count() + k];
    Plate<D>& plate = s.plates[s.plate_of[ghosts[k].carried] - 1];
    const auto add = [&](int face, double mass, double momentum, double mirrored) {
      s.sums[kAlong].water[face].mass += mass;
      s.sums[kAlong].water[face].momentum += momentum;
      s.image[kAlong][face].water += mirrored;
    };
    const double mass = out.mass, momentum = out.momentum, at_speed = 2 * plate.speed * mass;
    if (plate.folded) {
      add(ghosts[k].inner, mass, at_speed - momentum, 2 * mass - image.water);
      add(ghosts[k].carried, 2 * mass, at_speed, 2 * image.water);
      plate.mirrored += 2 * mass;
    } else {
      add(behind(ghosts[k]), mass, momentum, image.water);
    }
    out = {}, image = {};
  }
}

}  // namespace

template <int D>
void fold_plates(State<D>& s) {
  for (Plate<D>& plate : s.plates) {
    plate.folded = plate.active && plate.touches;
    plate.mirrored = 0, plate.slid = {};
  }
  fold_ghosts(s);
  for (Plate<D>& plate : s.plates) {
    if (!plate.folded) continue;
    const int up = s.grid.stride[kAlong];
    for (int face : plate.row) {
      FaceSums row = s.sums[kAlong][face];
      const FaceSums out = s.sums[kAlong][face + up];
      FaceImage &held = s.image[kAlong][face], &beyond = s.image[kAlong][face + up];
      row.soil_mass += 2 * out.soil_mass;
      row.grains += 2 * out.grains;
      plate.mirrored += 2 * out.soil_mass;
      row.soil_momentum += 2 * out.soil_mass * plate.speed;
      row.soil_force += 2 * out.soil_force;
      s.sums[kAlong].set_soil(face, row);
      held.soil += 2 * beyond.soil;
      fold_grains(s, kAlong, face - up, face + up, -1, plate.speed);
    }
    for (const auto& [d, inner] : plate.beside) {
      const double speed = plate.rise(s.time) * plate.velocity[d];
      if (plate.rough) plate.slid[d] += 2 * speed * s.sums[d][inner + up].soil_mass;
      fold_grains(s, d, inner, inner + up, plate.rough ? -1 : 1, speed);
    }
  }
}

namespace {

/// Velocities of ghosts, as they were folded.
template <int D>
void unfold_ghosts(State<D>& s) {
  const auto& ghosts = s.water_walls.ghosts(kAlong);
  for (std::size_t k = 0; k < ghosts.size(); ++k) {
    FaceSpeeds& out = s.speeds[kAlong][s.grid.count() + k];
    const FaceSpeeds& row = s.speeds[kAlong][ghosts[k].carried];
    if (s.plates[s.plate_of[ghosts[k].carried] - 1].folded) {
      const FaceSpeeds& in = s.speeds[kAlong][ghosts[k].inner];
      s.flow[kAlong][s.grid.count() + k] = {};
      out = {};
      out.water_old = 2 * row.water_old - in.water_old;
      out.water = 2 * row.water - in.water;
    } else {
      s.flow[kAlong][s.grid.count() + k] = s.flow[kAlong][behind(ghosts[k])];
      out = s.speeds[kAlong][behind(ghosts[k])];
    }
  }
}

/// The same for grains beyond the plane.
template <int D>
void unfold_grains(State<D>& s, const Plate<D>& plate) {
  const int up = s.grid.stride[kAlong];
  for (int face : plate.row) {
    const FaceSpeeds &in = s.speeds[kAlong][face - up], &row = s.speeds[kAlong][face];
    FaceSpeeds& out = s.speeds[kAlong][face + up];
    out.soil_old = 2 * row.soil_old - in.soil_old;
    out.soil = 2 * row.soil - in.soil;
  }
  for (const auto& [d, inner] : plate.beside) {
    const FaceSpeeds& in = s.speeds[d][inner];
    FaceSpeeds& out = s.speeds[d][inner + up];
    const double twice = plate.rough ? 2 * plate.rise(s.time) * plate.velocity[d] : 0,
                 sign = plate.rough ? -1 : 1;
    out.soil_old = twice + sign * in.soil_old;
    out.soil = twice + sign * in.soil;
  }
}

}  // namespace

template <int D>
void unfold_plates(State<D>& s) {
  for (const Plate<D>& plate : s.plates)
    if (plate.folded) unfold_grains(s, plate);
  unfold_ghosts(s);
}

namespace {

/// Next to nothing but air below the cell `above` the plane.
template <int D>
bool bare(const State<D>& s, int above) {
  const CellSums& below = s.cell_sums[above - s.grid.stride[kAlong]];
  return below.soil_bulk + below.water < 0.5 * s.volume.cell(above - s.grid.stride[kAlong]);
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

/// Makes the rows mirrors of the water's kernels. Ghosts begin with what lies behind them.
template <int D>
void make_ghosts(State<D>& s) {
  s.water_walls.carry_none();
  for (const Plate<D>& plate : s.plates)
    for (int face : plate.row) s.water_walls.carry(kAlong, face);
  s.water_walls.rebuild(s.grid);
  const auto& ghosts = s.water_walls.ghosts(kAlong);
  const std::size_t count = s.grid.count() + ghosts.size();
  const auto extend = [&](auto& field) {  // once: room that is not touched takes no memory
    field.reserve(2 * s.grid.count());
    field.resize(count);
  };
  s.sums[kAlong].each(extend), extend(s.image[kAlong]), extend(s.flow[kAlong]), extend(s.speeds[kAlong]);
  for (std::size_t k = 0; k < ghosts.size(); ++k) {
    s.sums[kAlong].clear(s.grid.count() + k);
    s.image[kAlong][s.grid.count() + k] = {};
    s.flow[kAlong][s.grid.count() + k] = s.flow[kAlong][behind(ghosts[k])];
    s.speeds[kAlong][s.grid.count() + k] = s.speeds[kAlong][behind(ghosts[k])];
  }
}

}  // namespace

template <int D>
void mark_plates(State<D>& s) {
  if (s.plates.empty()) return;
  s.plates_left_rows = false;
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
      // Where the ground ends with the plate, kernels reach one column beyond; that belongs to the plate too.
      const double beyond = bare(s, i) ? s.grid.h : 0;
      bool inside = true;
      for (int d = 0; d < D; ++d)
        if (d != kAlong) inside = inside && x[d] > plate.low[d] - beyond && x[d] < plate.high[d] + beyond;
      if (!inside || s.plate_of[i]) return;
      plate.row.push_back(i);
      s.plate_of[i] = static_cast<std::int32_t>(k + 1);
    });
    mark_beside(s, plate, static_cast<std::int32_t>(k + 1));
  }
  make_ghosts(s);
}

template <int D>
void mark_again(State<D>& s) {
  if (s.plates.empty()) return;
  s.plate_of.assign(s.grid.count(), 0);
  for (std::size_t k = 0; k < s.plates.size(); ++k)
    for (const int face : s.plates[k].row) s.plate_of.at(face) = static_cast<std::int32_t>(k + 1);
  make_ghosts(s);
}

template void mark_again<2>(State<2>&);
template void mark_again<3>(State<3>&);
template void fold_plates<2>(State<2>&);
template void fold_plates<3>(State<3>&);
template void unfold_plates<2>(State<2>&);
template void unfold_plates<3>(State<3>&);
template void mark_plates<2>(State<2>&);
template void mark_plates<3>(State<3>&);

}  // namespace quicksand

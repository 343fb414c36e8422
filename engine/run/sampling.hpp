#pragma once
// Values of the grid's fields at any place: what frames, probes and sections show.

#include "engine/step/state.hpp"

namespace quicksand {

/// Pore pressure at x, Pa: linear from the centre of the cell along each axis, with the gradient of the side
/// on which x lies, so that still water is exact up to walls and up to its surface. 0 in air.
template <int D>
double pressure_at(const State<D>& s, const Vec<D>& x);

/// Hydraulic head at x, m: elevation against gravity + p/(ρw g); p/(ρw·9.81) without gravity.
template <int D>
double head_at(const State<D>& s, const Vec<D>& x, double pressure);

template <int D>
Vec<D> water_velocity_at(const State<D>& s, const Vec<D>& x);
template <int D>
Vec<D> soil_velocity_at(const State<D>& s, const Vec<D>& x);

/// Porosity around x, –: 1 less the grains' share of the cell.
template <int D>
double porosity_at(const State<D>& s, const Vec<D>& x);

/// Room that the water takes, m³ (per metre in the plane, per radian about an axis): deep inside, where no
/// kernel reaches air, all that grains leave; elsewhere what is held, but no more than fits. It falls behind
/// what is held (mass over density) where points crowd, and exceeds it where they thin out without air
/// between them.
template <int D>
double water_volume(const State<D>& s);
/// Volume of the water's points, m³, at the moment that `water_volume` measures (the start of the last step).
template <int D>
double water_held(const State<D>& s);

/// Discharge of water through the faces on a segment along +x, +y or +z, m³/s (per metre in the plane).
template <int D>
double flow_through(const State<D>& s, const Segment& line);

}  // namespace quicksand

#include "engine/run/sampling.hpp"

#include <cmath>

#include "engine/grid/scene_grid.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

/// Gradient along axis d at the side of a wet cell where x lies; behind a wall, of the opposite side; between
/// two walls, that of still water.
template <int D>
double side_gradient(const State<D>& s, int cell, int d, int side) {
  const int face = cell + side * s.grid.stride[d], opposite = cell + (1 - side) * s.grid.stride[d];
  if (!s.water_walls.closed(d, face)) return pressure_gradient(s, d, face);
  return pressure_gradient(s, d, opposite);
}

template <int D>
double from_wet_cell(const State<D>& s, int cell, const Vec<D>& x) {
  const Vec<D> center = s.grid.center(s.grid.cell(cell));
  double p = s.pressure[cell];
  for (int d = 0; d < D; ++d) p += side_gradient(s, cell, d, x[d] > center[d] ? 1 : 0) * (x[d] - center[d]);
  return p;
}

template <int D, class Velocity>
Vec<D> velocity_at(const State<D>& s, const Walls<D>& walls, const Vec<D>& x, Velocity&& velocity) {
  Vec<D> v{};
  with_kernel(s.constants.kernel, [&](auto shape) {
    const PointKernel<D, decltype(shape)> kernel(s.grid, x);
    for (int d = 0; d < D; ++d)
      for_faces(s.grid, walls, kernel, d, [&](int face, double w, double sign, const Vec<D>&) {
        v[d] += sign * w * velocity(s.speeds[d][face]);
      });
  });
  return v;
}

/// Whether no kernel of the cell reaches air: it and its neighbours are wet, and theirs.
template <int D>
bool deep(const State<D>& s, int cell) {
  if (!s.cell[cell].confined) return false;
  for (int d = 0; d < D; ++d)
    for (int side : {0, 1}) {
      const int face = cell + side * s.grid.stride[d], other = cell + (2 * side - 1) * s.grid.stride[d];
      if (s.water_walls.closed(d, face) || in_plate(s, d, face) || submerged(s, d, face)) continue;
      if (!s.cell[other].confined) return false;
    }
  return true;
}

}  // namespace

template <int D>
double pressure_at(const State<D>& s, const Vec<D>& x) {
  const int cell = s.grid.index(s.grid.cell_of(x));
  if (s.cell[cell].wet()) return from_wet_cell<D>(s, cell, x);
  // Up to half a cell of water lies above the last wet centre.
  double p = 0;
  for (int d = 0; d < D; ++d)
    for (int side : {0, 1}) {
      const int face = cell + side * s.grid.stride[d], other = cell + (2 * side - 1) * s.grid.stride[d];
      if (!s.water_walls.closed(d, face) && s.cell[other].wet())
        p = std::max(p, from_wet_cell<D>(s, other, x));
    }
  return p;
}

template <int D>
double head_at(const State<D>& s, const Vec<D>& x, double pressure) {
  constexpr double kStandardGravity = 9.81;  // m/s², for scenes without gravity
  double g2 = 0, along = 0;
  for (int d = 0; d < D; ++d)
    g2 += s.constants.gravity[d] * s.constants.gravity[d], along -= s.constants.gravity[d] * x[d];
  const double g = std::sqrt(g2);
  return g > 0 ? along / g + pressure / (s.constants.water_density * g)
               : pressure / (s.constants.water_density * kStandardGravity);
}

template <int D>
Vec<D> water_velocity_at(const State<D>& s, const Vec<D>& x) {
  return velocity_at<D>(s, s.water_walls, x, [](const FaceSpeeds& f) { return f.water; });
}

template <int D>
Vec<D> soil_velocity_at(const State<D>& s, const Vec<D>& x) {
  return velocity_at<D>(s, s.soil_walls, x, [](const FaceSpeeds& f) { return f.soil; });
}

template <int D>
double porosity_at(const State<D>& s, const Vec<D>& x) {
  double grains = 0;
  with_kernel(s.constants.kernel, [&](auto shape) {
    const PointKernel<D, decltype(shape)> kernel(s.grid, x);
    for_centers(s.grid, s.water_walls, kernel,
                [&](int c, double w) { grains += w * s.cell_sums[c].grains / s.volume.cell(c); });
  });
  return 1 - grains;
}

template <int D>
double water_volume(const State<D>& s) {
  return s.blocks.template sum<double>([&](int b) {
    double v = 0;
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
      if (s.water_walls.blocked(i)) return;
      const double held = s.cell_sums[i].water, room = s.cell[i].n * s.volume.cell(i);
      v += deep<D>(s, i) ? room : std::min(held, room);
    });
    return v;
  });
}

template <int D>
double water_held(const State<D>& s) {
  return s.blocks.template sum<double>([&](int b) {
    double v = 0;
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) { v += s.cell_sums[i].water; });
    return v;
  });
}

template <int D>
double flow_through(const State<D>& s, const Segment& line) {
  double flow = 0;
  for (const auto& [d, face] : faces_on(s.grid, line)) {
    const FaceFlow& f = s.flow[d][face];
    if (!f.wet || s.water_walls.closed(d, face)) continue;
    // At the water surface only the part of the face below it passes water.
    double part = 0;
    for (int cell : {face - s.grid.stride[d], face})
      part += 0.5 * std::clamp(0.5 + s.cell[cell].depth, 0.0, 1.0);
    if (submerged(s, d, face)) part = 1;
    flow += part * f.n * s.speeds[d][face].water * s.grid.face_area() * s.grid.face_radius(d, face);
  }
  return flow;
}

template double flow_through<2>(const State<2>&, const Segment&);
template double flow_through<3>(const State<3>&, const Segment&);
template double pressure_at<2>(const State<2>&, const Vec<2>&);
template double pressure_at<3>(const State<3>&, const Vec<3>&);
template double head_at<2>(const State<2>&, const Vec<2>&, double);
template double head_at<3>(const State<3>&, const Vec<3>&, double);
template Vec<2> water_velocity_at<2>(const State<2>&, const Vec<2>&);
template Vec<3> water_velocity_at<3>(const State<3>&, const Vec<3>&);
template Vec<2> soil_velocity_at<2>(const State<2>&, const Vec<2>&);
template Vec<3> soil_velocity_at<3>(const State<3>&, const Vec<3>&);
template double porosity_at<2>(const State<2>&, const Vec<2>&);
template double porosity_at<3>(const State<3>&, const Vec<3>&);
template double water_volume<2>(const State<2>&);
template double water_volume<3>(const State<3>&);
template double water_held<2>(const State<2>&);
template double water_held<3>(const State<3>&);

}  // namespace quicksand

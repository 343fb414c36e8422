#include "engine/step/pressure.hpp"

#include <cmath>

#include "engine/step/conjugate_gradients.hpp"
#include "engine/step/phases.hpp"
#include "engine/threads/parallel.hpp"

namespace quicksand {
namespace {

/// Relative excess of volume that counts as drift. Points move relative to the lattice all the time, which
/// changes what a cell seems to hold by a few per cent and back; only what is beyond is fed back.
constexpr double kDriftDeadBand = 0.02;
/// In water alone, where no drag turns feedback into seepage: 2 % left a U-tube 0.25 % too full for good.
constexpr double kFreeDeadBand = 0.005;
/// Largest part of a cell's volume that may be fed back per drift time.
constexpr double kDriftLimit = 0.2;

/// Cells that the water passes while drift is fed back. Drift comes from motion, so slow seepage gets a
/// feedback as slow as itself: a quicker one would turn the unevenness of the points into flow.
constexpr double kDriftCells = 4;

/// Largest speed of the water at the faces of a cell, m/s, at the start of the step.
template <int D>
double speed_in(const State<D>& s, int cell) {
  double speed = 0;
  for (int d = 0; d < D; ++d)
    for (int face : {cell, cell + s.grid.stride[d]})
      speed = std::max(speed, std::abs(s.speeds[d][face].water_old));
  return speed;
}

/// Largest part of a cell's width per second that drift may be fed back over, 1/s. Among grains it is slow
/// (see above). Water alone may not stay compressed at rest either: a wave as long as the cell passes it in
/// the meantime.
template <int D>
double drift_pace(const State<D>& s, int cell) {
  const double inverse_h = s.grid.inverse_h, passes = speed_in(s, cell) * inverse_h;
  if (s.cell_sums[cell].grains > 0) return passes / kDriftCells;
  return std::max(passes, cell_wave(s) * inverse_h);
}

/// 1/s
template <int D>
double drift_rate(const State<D>& s, int cell) {
  const double excess = s.cell[cell].excess;
  const double band = (s.cell_sums[cell].grains > 0 ? kDriftDeadBand : kFreeDeadBand) +
                      std::abs(s.pressure[cell]) * s.constants.water_compliance;
  if (s.constants.drift_time <= 0 || std::abs(excess) <= band) return 0;
  const double beyond = excess - std::copysign(band, excess);
  const double rate = std::min(1 / s.constants.drift_time, drift_pace(s, cell));
  return std::clamp(beyond, -kDriftLimit, kDriftLimit) * rate;
}

/// Rows block by block, so that neighbours in space are near in memory.
template <int D>
void number_rows(State<D>& s, PressureSystem<D>& m) {
  std::vector<int> end(s.blocks.count() + 1, 0);
  const auto wet_cells = [&](int b, auto&& f) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
      if (s.cell[i].wet()) f(i);
    });
  };
  s.blocks.all([&](int b) { wet_cells(b, [&](int) { ++end[b + 1]; }); });
  for (int b = 0; b < s.blocks.count(); ++b) end[b + 1] += end[b];
  m.cell.resize(end.back());
  s.blocks.all([&](int b) {
    int row = end[b];
    wet_cells(b, [&](int i) {
      m.cell[row] = i;
      s.cell[i].row = ++row;
    });
  });
  for (auto& piston : m.pistons) {
    piston.row.clear();
    for (int cell : piston.cell) piston.row.push_back(s.cell[cell].row - 1);
  }
}

/// Pa, how the pressure has changed in the last step: the direction in which the solution begins.
template <int D>
double last_change(const State<D>& s, int cell) {
  const double before = s.pressure_before[cell];
  return before == 0 ? 0 : s.pressure[cell] - before;
}

/// About an axis a row is the balance of its cell per radian, so that the matrix stays symmetric: storage and
/// drift times the cell's radius, fluxes times their face's.
template <int D, bool kAxial>
void assemble(State<D>& s, PressureSystem<D>& m, double dt) {
  const std::size_t rows = m.cell.size();
  m.diagonal.resize(rows), m.rhs.resize(rows), m.solution.resize(rows), m.change.resize(rows);
  for (int d = 0; d < D; ++d) m.upper[d].resize(rows), m.lower[d].resize(rows), m.coupling[d].resize(rows);
  const double inverse_h = s.grid.inverse_h, inverse_h2 = inverse_h * inverse_h;
  parallel_parts(rows, 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const int i = m.cell[r];
      const CellState& c = s.cell[i];
      const double radius = kAxial ? s.grid.cell_radius(i) : 1;
      const double storage = radius * c.n * s.constants.water_compliance / dt;
      double diagonal = storage;
      double rhs = storage * s.pressure[i] + radius * drift_rate(s, i);
      for (int d = 0; d < D; ++d) {
        m.upper[d][r] = m.lower[d][r] = -1;
        m.coupling[d][r] = 0;
        for (int side : {0, 1}) {
          const int face = i + side * s.grid.stride[d], other = i + (2 * side - 1) * s.grid.stride[d];
          if (s.water_walls.closed(d, face)) continue;
          const FaceFlow& f = s.flow[d][face];
          const double at = kAxial ? s.grid.face_radius(d, face) : 1;
          rhs += (1 - 2 * side) * at * f.flux(s.speeds[d][face]) * inverse_h;
          const double beta = at * f.flux_response() * inverse_h2;
          const CellState& o = s.cell[other];
          if (const Port<D>* port = port_at(s, d, face)) {
            diagonal += 2 * beta;  // half a cell to the face
            rhs += 2 * beta * port->pressure;
            continue;
          }
          if (!o.wet()) {
            diagonal += beta / surface_distance(c.depth, o.depth);
            continue;
          }
          diagonal += beta;
          (side ? m.upper : m.lower)[d][r] = o.row - 1;
          if (side) m.coupling[d][r] = -beta;
        }
      }
      if (diagonal <= 0)
        diagonal = 1, rhs = s.pressure[i];  // a closed cell of incompressible water: as it was
      m.diagonal[r] = diagonal;
      m.rhs[r] = rhs;
      m.solution[r] = s.pressure[i];
      m.change[r] = last_change(s, i);
    }
  });
}

/// One step of the explicit scheme. A row's sum is the part of its diagonal that belongs to the cell alone:
/// storage and the water surface.
template <int D>
void advance_explicitly(PressureSystem<D>& m) {
  std::vector<double> image(m.cell.size());
  multiply(m, m.solution, image);
  for (std::size_t r = 0; r < m.cell.size(); ++r) {
    double own = m.diagonal[r];
    for (int d = 0; d < D; ++d) {
      if (m.upper[d][r] >= 0) own += m.coupling[d][r];
      if (const int j = m.lower[d][r]; j >= 0) own += m.coupling[d][j];
    }
    m.solution[r] += (m.rhs[r] - image[r]) / own;
  }
}

}  // namespace

template <int D>
PressureReport solve_pressure(State<D>& s, double dt) {
  if (!s.has_water) return {};
  PressureSystem<D>& system = s.pressure_system;
  number_rows(s, system);
  if (system.cell.empty()) return {};
  with_axial(s.grid, [&](auto axial) { assemble<D, axial>(s, system, dt); });
  PressureReport report{static_cast<int>(system.cell.size())};
  if (s.constants.explicit_pressure)
    advance_explicitly(system);
  else
    report = conjugate_gradients(s.grid, system, s.multigrid, s.constants.pressure_tolerance);
  for (std::size_t r = 0; r < system.cell.size(); ++r) s.pressure[system.cell[r]] = system.solution[r];
  return report;
}

template PressureReport solve_pressure<2>(State<2>&, double);
template PressureReport solve_pressure<3>(State<3>&, double);

}  // namespace quicksand

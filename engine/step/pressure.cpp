#include "engine/step/pressure.hpp"

#include <cmath>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Relative excess of volume that counts as drift. Points move relative to the lattice all the time, which
/// changes what a cell seems to hold by a few per cent and back; only what is beyond is fed back.
constexpr double kDriftDeadBand = 0.02;
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
      speed = std::max(speed, std::abs(s.flow[d][face].water_old));
  return speed;
}

/// 1/s
template <int D>
double drift_rate(const State<D>& s, int cell) {
  const double excess = s.cell[cell].excess;
  if (s.constants.drift_time <= 0 || std::abs(excess) <= kDriftDeadBand) return 0;
  const double beyond = excess - std::copysign(kDriftDeadBand, excess);
  const double rate =
      std::min(1 / s.constants.drift_time, speed_in(s, cell) * s.grid.inverse_h / kDriftCells);
  return std::clamp(beyond, -kDriftLimit, kDriftLimit) * rate;
}

template <int D>
void number_rows(State<D>& s, PressureSystem<D>& m) {
  m.cell.clear();
  for_each_cell(s.grid, [&](int i, const Cell<D>&) {
    if (s.cell[i].unknown < 0) return;
    s.cell[i].unknown = static_cast<int>(m.cell.size());
    m.cell.push_back(i);
  });
  for (auto& piston : m.pistons) {
    piston.row.clear();
    for (int cell : piston.cell) piston.row.push_back(s.cell[cell].unknown);
  }
}

/// About an axis a row is the balance of its cell per radian, so that the matrix stays symmetric: storage and
/// drift times the cell's radius, fluxes times their face's.
template <int D, bool kAxial>
void assemble(State<D>& s, PressureSystem<D>& m, double dt) {
  const std::size_t rows = m.cell.size();
  m.diagonal.resize(rows), m.rhs.resize(rows), m.solution.resize(rows);
  for (int d = 0; d < D; ++d) m.upper[d].resize(rows), m.lower[d].resize(rows), m.coupling[d].resize(rows);
  const double inverse_h = s.grid.inverse_h, inverse_h2 = inverse_h * inverse_h;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows, 512), [&](const auto& range) {
    for (std::size_t r = range.begin(); r < range.end(); ++r) {
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
          rhs += (1 - 2 * side) * at * f.flux() * inverse_h;
          const double beta = at * f.flux_response() * inverse_h2;
          const CellState& o = s.cell[other];
          if (const Port<D>* port = port_at(s, d, face)) {
            diagonal += 2 * beta;  // half a cell to the face
            rhs += 2 * beta * port->pressure;
            continue;
          }
          if (o.unknown < 0) {
            diagonal += beta / surface_distance(c.depth, o.depth);
            continue;
          }
          diagonal += beta;
          (side ? m.upper : m.lower)[d][r] = o.unknown;
          if (side) m.coupling[d][r] = -beta;
        }
      }
      if (diagonal <= 0)
        diagonal = 1, rhs = s.pressure[i];  // a closed cell of incompressible water: as it was
      m.diagonal[r] = diagonal;
      m.rhs[r] = rhs;
      m.solution[r] = s.pressure[i];
    }
  });
}

/// Modified incomplete Cholesky without fill. `kModified` keeps the row sums, which halves the iterations
/// on long columns; slightly below 1 so that pivots stay positive.
template <int D>
struct Preconditioner {
  static constexpr double kModified = 0.97, kSmallestPivot = 0.25;
  std::vector<double> pivot, half;

  void factor(const PressureSystem<D>& m) {
    const std::size_t rows = m.cell.size();
    pivot.resize(rows);
    half.resize(rows);
    for (std::size_t r = 0; r < rows; ++r) {
      double e = m.diagonal[r];
      for (int d = 0; d < D; ++d) {
        const int j = m.lower[d][r];
        if (j < 0) continue;
        const double a = m.coupling[d][j] * pivot[j];
        double others = 0;
        for (int k = 0; k < D; ++k)
          if (k != d) others += m.coupling[k][j];
        e -= a * a + kModified * a * others * pivot[j];
      }
      if (e < kSmallestPivot * m.diagonal[r]) e = m.diagonal[r];
      pivot[r] = 1 / std::sqrt(e);
    }
  }
  void apply(const PressureSystem<D>& m, const std::vector<double>& in, std::vector<double>& out) {
    const int rows = static_cast<int>(m.cell.size());
    for (int r = 0; r < rows; ++r) {
      double t = in[r];
      for (int d = 0; d < D; ++d)
        if (const int j = m.lower[d][r]; j >= 0) t -= m.coupling[d][j] * pivot[j] * half[j];
      half[r] = t * pivot[r];
    }
    for (int r = rows - 1; r >= 0; --r) {
      double t = half[r];
      for (int d = 0; d < D; ++d)
        if (const int j = m.upper[d][r]; j >= 0) t -= m.coupling[d][r] * pivot[r] * out[j];
      out[r] = t * pivot[r];
    }
  }
};

template <int D>
void multiply(const PressureSystem<D>& m, const std::vector<double>& x, std::vector<double>& y) {
  for (std::size_t r = 0; r < m.cell.size(); ++r) {
    double t = m.diagonal[r] * x[r];
    for (int d = 0; d < D; ++d) {
      if (const int j = m.upper[d][r]; j >= 0) t += m.coupling[d][r] * x[j];
      if (const int j = m.lower[d][r]; j >= 0) t += m.coupling[d][j] * x[j];
    }
    y[r] = t;
  }
  for (const auto& piston : m.pistons) {
    double sum = 0;
    for (std::size_t k = 0; k < piston.row.size(); ++k) sum += piston.weight[k] * x[piston.row[k]];
    for (std::size_t k = 0; k < piston.row.size(); ++k)
      y[piston.row[k]] += piston.response * piston.weight[k] * sum;
  }
}

double largest(const std::vector<double>& v) {
  double m = 0;
  for (double x : v) m = std::abs(x) > m || std::isnan(x) ? std::abs(x) : m;
  return m;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Size of the terms that cancel in a row, times rounding: no residual can be asked to be smaller.
constexpr double kRounding = 1e-15;
template <int D>
double largest_term(const PressureSystem<D>& m) {
  double term = 0;
  for (std::size_t r = 0; r < m.cell.size(); ++r)
    term = std::max(term, std::abs(m.diagonal[r] * m.solution[r]));
  return term;
}

/// Preconditioned conjugate gradients on `m`, from `m.solution`.
template <int D>
PressureReport conjugate_gradients(PressureSystem<D>& m, double tolerance) {
  constexpr int kMaxIterations = 2000;
  const std::size_t rows = m.cell.size();
  PressureReport report{static_cast<int>(rows)};
  std::vector<double> r(rows), z(rows), direction(rows), image(rows);
  multiply(m, m.solution, image);
  for (std::size_t i = 0; i < rows; ++i) r[i] = m.rhs[i] - image[i];
  const double scale = largest(m.rhs), target = tolerance * scale + kRounding * largest_term(m);
  double residual = largest(r);
  if (residual > target) {
    Preconditioner<D> preconditioner;
    preconditioner.factor(m);
    preconditioner.apply(m, r, z);
    direction = z;
    double rz = dot(r, z);
    while (residual > target && report.iterations < kMaxIterations) {
      multiply(m, direction, image);
      const double alpha = rz / dot(direction, image);
      for (std::size_t i = 0; i < rows; ++i) {
        m.solution[i] += alpha * direction[i];
        r[i] -= alpha * image[i];
      }
      ++report.iterations;
      residual = largest(r);
      if (residual <= target) break;
      preconditioner.apply(m, r, z);
      const double next = dot(r, z);
      for (std::size_t i = 0; i < rows; ++i) direction[i] = z[i] + next / rz * direction[i];
      rz = next;
    }
  }
  report.residual = scale > 0 ? residual / scale : 0;
  report.converged = residual <= target;
  return report;
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
  PressureSystem<D>& system = s.pressure_system;
  number_rows(s, system);
  if (system.cell.empty()) return {};
  with_axial(s.grid, [&](auto axial) { assemble<D, axial>(s, system, dt); });
  PressureReport report{static_cast<int>(system.cell.size())};
  if (s.constants.explicit_pressure)
    advance_explicitly(system);
  else
    report = conjugate_gradients(system, s.constants.pressure_tolerance);
  for (std::size_t r = 0; r < system.cell.size(); ++r) s.pressure[system.cell[r]] = system.solution[r];
  return report;
}

template PressureReport solve_pressure<2>(State<2>&, double);
template PressureReport solve_pressure<3>(State<3>&, double);

}  // namespace quicksand

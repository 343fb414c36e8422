#include "engine/step/pressure.hpp"

#include <atomic>
#include <cmath>
#include <utility>

#include "engine/step/conjugate_gradients.hpp"
#include "engine/step/phases.hpp"
#include "engine/threads/chunks.hpp"

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
/// (see above). Water alone may not stay compressed at rest either, and no gap may stay: a wave as long as
/// the cell passes it in the meantime.
template <int D>
double drift_pace(const State<D>& s, int cell) {
  const double inverse_h = s.grid.inverse_h, passes = speed_in(s, cell) * inverse_h;
  if (s.cell_sums[cell].grains > 0 && !s.cell[cell].is_gap()) return passes / kDriftCells;
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

/// Lines of cells along x in a block.
template <int D>
constexpr int kLines = Blocks<D>::kCells / Blocks<D>::kEdge;
/// Which of them a cell lies in.
template <int D>
int line_of(const Cell<D>& c) {
  int line = 0;
  for (int d = D - 1; d > 0; --d) line = line * Blocks<D>::kEdge + c[d] % Blocks<D>::kEdge;
  return line;
}
/// 0 or 1: which cells' rows come first.
template <int D>
int color_of(const Cell<D>& c) {
  int sum = 0;
  for (const int i : c) sum += i;
  return sum & 1;
}

/// Rows in the order that PressureSystem tells. Blocks that follow each other along x share their lines.
template <int D>
void number_rows(State<D>& s, PressureSystem<D>& m) {
  const int blocks = s.blocks.count();
  using Counts = std::array<std::array<int, kLines<D>>, 2>;  // of a block's wet cells, per colour and line
  std::vector<Counts> next(blocks);                          // then the rows that they begin with
  const auto wet_cells = [&](int b, auto&& f) {
    s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>& c) {
      if (s.cell[i].wet()) f(i, next[b][color_of<D>(c)][line_of<D>(c)]);
    });
  };
  s.blocks.all([&](int b) {
    next[b] = {};
    wet_cells(b, [](int, int& count) { ++count; });
  });
  int row = 0;
  for (const int color : {0, 1}) {
    for (int first = 0, end; first < blocks; first = end) {
      end = first + 1;
      while (end < blocks && s.blocks.beside(end)) ++end;
      for (int line = 0; line < kLines<D>; ++line)
        for (int b = first; b < end; ++b) row += std::exchange(next[b][color][line], row);
    }
    if (color == 0) m.even = row;
  }
  resize_with_spare(m.cell, static_cast<std::size_t>(row));
  std::atomic<bool> changed = m.changed;
  s.blocks.all([&](int b) {
    bool differ = false;
    wet_cells(b, [&](int i, int& at) {
      differ = differ || m.cell[at] != i;
      m.cell[at] = i;
      s.cell[i].row = ++at;
    });
    if (differ) changed.store(true, std::memory_order_relaxed);
  });
  m.changed = changed;
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

/// Makes the row of a wet cell, which has it.
template <int D>
class RowMaker {
 public:
  RowMaker(const State<D>& s, PressureSystem<D>& m, double dt)
      : s_(s), m_(m), storage_(s.constants.water_compliance / dt) {}

  /// About an axis a row is the balance of its cell per radian, so that the matrix stays symmetric: storage
  /// and drift times the cell's radius, fluxes times their face's.
  template <bool axial>
  void make(int i) {
    const double radius = axial ? s_.grid.cell_radius(i) : 1;
    start(i, radius);
    for (int d = 0; d < D; ++d)
      for (int side : {0, 1}) {
        const int face = i + side * s_.grid.stride[d], other = i + (2 * side - 1) * s_.grid.stride[d];
        if (s_.water_walls.closed(d, face))
          couple(2 * d + side, -1, 0);
        else
          add_side(2 * d + side, face, s_.cell[i], s_.cell[other], axial ? s_.grid.face_radius(d, face) : 1);
      }
    finish(i);
  }
  /// The same in a plain block, where all sides are open and wet.
  void make_plain(int i) {
    start(i, 1);
    for (int d = 0; d < D; ++d)
      for (int side : {0, 1}) {
        const int face = i + side * s_.grid.stride[d], other = i + (2 * side - 1) * s_.grid.stride[d];
        const double beta = s_.flux_response[d][face] * per_area_;
        rhs_ += (1 - 2 * side) * s_.flux[d][face] * s_.grid.inverse_h;
        diagonal_ += beta;
        couple(2 * d + side, s_.cell[other].row - 1, beta);
      }
    finish(i);
  }
  bool changed() const { return changed_; }  ///< some row's neighbours are others than before

 private:
  void start(int i, double radius) {
    row_ = s_.cell[i].row - 1;
    diagonal_ = radius * s_.cell[i].n * storage_;
    rhs_ = diagonal_ * s_.pressure[i] + radius * drift_rate(s_, i);
  }
  void couple(int side, int neighbor, double beta) {
    if (int& known = m_.neighbor[side][row_]; known != neighbor) {  // rarely: what is not written stays clean
      known = neighbor;
      changed_ = true;
    }
    m_.matrix.coupling[side][row_] = beta;
  }
  void add_side(int side, int face, const CellState& cell, const CellState& other, double at) {
    const int d = side / 2;
    rhs_ += (1 - 2 * (side % 2)) * at * s_.flux[d][face] * s_.grid.inverse_h;
    const double beta = at * s_.flux_response[d][face] * per_area_;
    const Port<D>* port = port_at(s_, d, face);
    const bool inner = !port && other.wet();
    couple(side, inner ? other.row - 1 : -1, inner ? beta : 0);
    if (inner) {
      diagonal_ += beta;
    } else if (port) {
      diagonal_ += 2 * beta;  // half a cell to the face
      rhs_ += 2 * beta * port->pressure;
    } else {
      diagonal_ += beta / surface_distance(cell.depth, other.depth);
    }
  }
  void finish(int i) {
    // A closed cell of incompressible water stays as it was.
    if (diagonal_ <= 0) diagonal_ = 1, rhs_ = s_.pressure[i];
    m_.matrix.diagonal[row_] = diagonal_;
    m_.rhs[row_] = rhs_;
    m_.solution[row_] = s_.pressure[i];
    m_.change[row_] = last_change(s_, i);
  }

  const State<D>& s_;
  PressureSystem<D>& m_;
  const double storage_, per_area_ = s_.grid.inverse_h * s_.grid.inverse_h;  ///< 1/(Pa·s), 1/m²
  std::size_t row_ = 0;
  double diagonal_ = 0, rhs_ = 0;
  bool changed_ = false;
};

template <int D>
void assemble(State<D>& s, PressureSystem<D>& m, double dt) {
  m.resize();
  std::atomic<bool> changed = m.changed;
  with_axial(s.grid, [&](auto axial) {
    s.blocks.all([&](int b) {
      RowMaker<D> rows(s, m, dt);
      s.blocks.cells(s.grid, b, false, [&](int i, const Cell<D>&) {
        if (s.plain[b])
          rows.make_plain(i);
        else if (s.cell[i].wet())
          rows.template make<axial>(i);
      });
      if (rows.changed()) changed.store(true, std::memory_order_relaxed);
    });
  });
  m.changed = changed;
}

/// One step of the explicit scheme. A row's sum is the part of its diagonal that belongs to the cell alone:
/// storage and the water surface.
template <int D>
void advance_explicitly(PressureSystem<D>& m) {
  std::vector<double> image(m.cell.size());
  multiply(m, m.solution, image);
  for (std::size_t r = 0; r < m.cell.size(); ++r) {
    double own = m.matrix.diagonal[r];
    for (const auto& side : m.matrix.coupling) own -= side[r];
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
  assemble(s, system, dt);
  PressureReport report{static_cast<int>(system.cell.size())};
  if (s.constants.explicit_pressure)
    advance_explicitly(system);
  else
    report = conjugate_gradients(s.grid, system, s.multigrid, s.constants.pressure_tolerance);
  for_chunks(system.cell.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) s.pressure[system.cell[r]] = system.solution[r];
  });
  return report;
}

template PressureReport solve_pressure<2>(State<2>&, double);
template PressureReport solve_pressure<3>(State<3>&, double);

}  // namespace quicksand

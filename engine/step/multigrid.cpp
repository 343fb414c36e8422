#include "engine/step/multigrid.hpp"

#include <algorithm>

#include "engine/threads/chunks.hpp"

namespace quicksand {
namespace {

/// Levels are added until one has at most this many rows, which a few sweeps solve.
constexpr std::size_t kFewRows = 16;
constexpr int kLastSweeps = 4;
/// Rows of a run at most, so that threads find parts of it.
constexpr int kLongestRun = 1024;

/// Σ over the sides of coupling × x of the neighbour, for row `row` of a run.
template <int sides>
struct Sides {
  std::array<const double*, sides> coupling, x;

  template <class Matrix, class Run>
  Sides(const Matrix& matrix, const Run& run, const double* vector) {
    for (int k = 0; k < sides; ++k) {
      coupling[k] = matrix.coupling[k].data() + run.first;
      x[k] = vector + run.neighbor[k];
    }
  }
  double sum(int row) const {
    double t = 0;
    for (int k = 0; k < sides; ++k) t += coupling[k][row] * x[k][row];
    return t;
  }
};

}  // namespace

template <int D>
void Multigrid<D>::find_runs(Level& level, const Neighbors& neighbor) {
  const int n = static_cast<int>(level.rows());
  for (const int color : {0, 1}) {
    std::vector<Run>& runs = level.runs[color];
    runs.clear(), level.parts[color] = {0};
    int in_part = 0;
    for (int r = color ? level.even : 0, end = color ? n : level.even; r < end; ++r) {
      const auto goes_on = [&](const Run& run) {
        if (run.count == kLongestRun) return false;
        for (int k = 0; k < kSides; ++k) {
          const bool none = run.neighbor[k] == run.first;
          if (neighbor[k][r] != (none ? -1 : run.neighbor[k] + run.count)) return false;
        }
        return true;
      };
      if (in_part >= static_cast<int>(kChunk)) {
        level.parts[color].push_back(static_cast<int>(runs.size()));
        in_part = 0;
      }
      if (in_part == 0 || !goes_on(runs.back())) {
        runs.push_back({r, 0, {}});
        for (int k = 0; k < kSides; ++k) runs.back().neighbor[k] = neighbor[k][r] < 0 ? r : neighbor[k][r];
      }
      ++runs.back().count, ++in_part;
    }
    level.parts[color].push_back(static_cast<int>(runs.size()));
  }
}

/// f(run) for the runs of a colour.
template <int D>
template <class F>
void Multigrid<D>::for_runs(const Level& level, int color, F&& f) {
  const std::vector<int>& parts = level.parts[color];
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (int i = parts[begin]; i < parts[end]; ++i) f(level.runs[color][i]);
  };
  if (parts.size() < 4)
    some(0, parts.size() - 1);
  else
    parallel_parts(parts.size() - 1, 1, some);
}

template <int D>
void Multigrid<D>::build_structure(const Grid<D>& grid, const PressureSystem<D>& m) {
  cells_ = m.cell, neighbors_ = m.neighbor;
  std::vector<Cell<D>> place;
  for (const int cell : m.cell) place.push_back(grid.cell(cell));
  levels_.assign(1, {});
  const auto make_vectors = [](Level& level, std::size_t rows, int even) {
    level.even = even;
    for (auto* v : {&level.inverse, &level.x, &level.b}) v->assign(rows, 0);
    level.left.assign(even, 0);
  };
  make_vectors(levels_[0], m.cell.size(), m.even);
  find_runs(levels_[0], m.neighbor);
  while (levels_.back().rows() > kFewRows) {
    Level coarse;
    const Neighbors neighbor = coarsen(levels_.back(), coarse, place);
    make_vectors(coarse, place.size(), coarse.even);
    find_runs(coarse, neighbor);
    const bool stuck = coarse.rows() == levels_.back().rows();
    if (stuck) break;
    levels_.push_back(std::move(coarse));
  }
}

/// Rows of the cubes that hold rows of `fine`; `place`, of the rows of `fine`, becomes that of the cubes.
template <int D>
typename Multigrid<D>::Neighbors Multigrid<D>::coarsen(Level& fine, Level& coarse,
                                                       std::vector<Cell<D>>& place) {
  Cell<D> low = place[0], high = low, size, step;
  for (const Cell<D>& c : place)
    for (int d = 0; d < D; ++d) low[d] = std::min(low[d], c[d] >> 1), high[d] = std::max(high[d], c[d] >> 1);
  std::size_t slots = 1;
  for (int d = 0; d < D; ++d) {
    size[d] = high[d] - low[d] + 1;
    step[d] = static_cast<int>(slots);
    slots *= size[d];
  }
  const auto slot = [&](const Cell<D>& c) {
    int i = 0;
    for (int d = 0; d < D; ++d) i += ((c[d] >> 1) - low[d]) * step[d];
    return i;
  };
  std::vector<int> row_at(slots, -1);
  for (const Cell<D>& c : place) row_at[slot(c)] = 0;
  std::vector<Cell<D>> cubes;
  std::vector<int> at;  // slots
  for (const int color : {0, 1}) {
    for (std::size_t first = 0; first < slots; first += size[0]) {
      Cell<D> c = low;
      for (std::size_t d = 1, rest = first / size[0]; d < D; rest /= size[d], ++d)
        c[d] += static_cast<int>(rest % size[d]);
      int parity = 0;
      for (const int i : c) parity ^= i & 1;
      for (int x = parity ^ color; x < size[0]; x += 2) {
        if (row_at[first + x] < 0) continue;
        at.push_back(static_cast<int>(first) + x);
        c[0] = low[0] + x;
        cubes.push_back(c);
      }
    }
    if (color == 0) coarse.even = static_cast<int>(cubes.size());
  }
  const int n = static_cast<int>(cubes.size());
  for (int r = 0; r < n; ++r) row_at[at[r]] = r;
  coarse.children.resize(n);
  for (auto& of : coarse.children) of.fill(-1);
  fine.parent.resize(place.size());
  for (std::size_t r = 0; r < place.size(); ++r) {
    int child = 0;
    for (int d = 0; d < D; ++d) child |= (place[r][d] & 1) << d;
    const int row = row_at[slot(place[r])];
    coarse.children[row][child] = static_cast<int>(r);
    fine.parent[r] = row;
  }
  coarse.own.resize(n);
  Neighbors neighbor;
  for (int k = 0; k < kSides; ++k) {
    neighbor[k].resize(n);
    const int d = k / 2, edge = k % 2 ? high[d] : low[d], by = k % 2 ? step[d] : -step[d];
    for (int r = 0; r < n; ++r) neighbor[k][r] = cubes[r][d] == edge ? -1 : row_at[at[r] + by];
  }
  place = std::move(cubes);
  return neighbor;
}

template <int D>
void Multigrid<D>::fill_coarse(const Level& fine, Level& coarse) {
  const Stencil<D>& from = *fine.matrix;
  for_chunks(coarse.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      std::array<double, kSides> beta{};
      double own = 0;  // storage and surface
      for (int number = 0; number < kChildren; ++number) {
        const int child = coarse.children[r][number];
        if (child < 0) continue;
        own += from.diagonal[child];
        for (int k = 0; k < kSides; ++k) {
          own -= from.coupling[k][child];
          const bool outward = ((number >> (k / 2)) & 1) == (k & 1);
          if (outward) beta[k] += 0.5 * from.coupling[k][child];
        }
      }
      double diagonal = std::max(own, 0.0);
      for (int k = 0; k < kSides; ++k) diagonal += coarse.own.coupling[k][r] = beta[k];
      coarse.own.diagonal[r] = diagonal;
      coarse.inverse[r] = diagonal > 0 ? 1 / diagonal : 0;
    }
  });
}

template <int D>
void Multigrid<D>::build(const Grid<D>& grid, const PressureSystem<D>& m) {
  if (levels_.empty() || m.cell != cells_ || m.neighbor != neighbors_) build_structure(grid, m);
  Level& fine = levels_[0];
  fine.matrix = &m.matrix;
  for_chunks(fine.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) fine.inverse[r] = 1 / m.matrix.diagonal[r];
  });
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    levels_[k].matrix = &levels_[k].own;
    fill_coarse(levels_[k - 1], levels_[k]);
  }
}

template <int D>
void Multigrid<D>::multiply(const std::vector<double>& x, std::vector<double>& y) const {
  const Level& fine = levels_[0];
  for (const int color : {0, 1})
    for_runs(fine, color, [&](const Run& run) {
      const Sides<kSides> sides(*fine.matrix, run, x.data());
      const double *diagonal = fine.matrix->diagonal.data() + run.first, *own = x.data() + run.first;
      double* __restrict out = y.data() + run.first;
      for (int i = 0; i < run.count; ++i) out[i] = diagonal[i] * own[i] - sides.sum(i);
    });
}

/// Sets the rows of a colour to what their neighbours ask for.
template <int D>
void Multigrid<D>::relax(Level& level, int color) {
  for_runs(level, color, [&](const Run& run) {
    const Sides<kSides> sides(*level.matrix, run, level.x.data());
    const double *b = level.b.data() + run.first, *inverse = level.inverse.data() + run.first;
    double* x = level.x.data() + run.first;
#pragma GCC ivdep  // neighbours are of the other colour, or the row itself times 0
    for (int i = 0; i < run.count; ++i) x[i] = (b[i] + sides.sum(i)) * inverse[i];
  });
}

/// relax of the even rows where all x are zero still.
template <int D>
void Multigrid<D>::start(Level& level) {
  for_chunks(level.even, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) level.x[r] = level.b[r] * level.inverse[r];
  });
  std::fill(level.x.begin() + level.even, level.x.end(), 0);
}

/// What start and relax of the odd rows leave over: of even rows what came from these since, of odd ones
/// nothing.
template <int D>
void Multigrid<D>::restrict_to(Level& coarse, Level& fine) {
  for_runs(fine, 0, [&](const Run& run) {
    const Sides<kSides> sides(*fine.matrix, run, fine.x.data());
    double* __restrict left = fine.left.data() + run.first;
    for (int i = 0; i < run.count; ++i) left[i] = sides.sum(i);
  });
  for_chunks(coarse.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      double sum = 0;
      for (const int child : coarse.children[r])
        if (child >= 0 && child < fine.even) sum += fine.left[child];
      coarse.b[r] = sum;
    }
  });
}

template <int D>
void Multigrid<D>::cycle(std::size_t k) {
  Level& level = levels_[k];
  start(level);
  relax(level, 1);
  if (k + 1 == levels_.size()) {
    for (int i = 1; i < kLastSweeps; ++i) relax(level, 0), relax(level, 1);
    for (int i = 0; i < kLastSweeps; ++i) relax(level, 1), relax(level, 0);
    return;
  }
  Level& coarse = levels_[k + 1];
  restrict_to(coarse, level);
  cycle(k + 1);
  for_chunks(level.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) level.x[r] += coarse.x[level.parent[r]];
  });
  relax(level, 1), relax(level, 0);
}

template <int D>
void Multigrid<D>::apply(const std::vector<double>& in, std::vector<double>& out) {
  Level& fine = levels_[0];
  std::copy(in.begin(), in.end(), fine.b.begin());
  cycle(0);
  std::copy(fine.x.begin(), fine.x.end(), out.begin());
}

template <int D>
double Multigrid<D>::bytes() const {
  std::size_t sum = cells_.capacity() * sizeof(int);
  for (const auto& side : neighbors_) sum += side.capacity() * sizeof(int);
  for (const Level& l : levels_) {
    for (const auto* v : {&l.inverse, &l.x, &l.b, &l.left, &l.own.diagonal})
      sum += v->capacity() * sizeof(double);
    for (const auto& side : l.own.coupling) sum += side.capacity() * sizeof(double);
    for (const auto& runs : l.runs) sum += runs.capacity() * sizeof(Run);
    sum += l.parent.capacity() * sizeof(int) + l.children.capacity() * sizeof(l.children[0]);
  }
  return static_cast<double>(sum);
}

template class Multigrid<2>;
template class Multigrid<3>;

}  // namespace quicksand

#include "engine/step/multigrid.hpp"

#include <algorithm>

#include "engine/threads/chunks.hpp"

namespace quicksand {
namespace {

/// Levels are added until one has at most this many rows, which a few sweeps solve.
constexpr std::size_t kFewRows = 16;
constexpr int kLastSweeps = 4;

}  // namespace

template <int D>
void Multigrid<D>::finish_level(Level& level) {
  const std::size_t n = level.rows.size();
  level.x.assign(n + 1, 0);
  level.b.assign(n, 0);
  for (auto& rows : level.colored) rows.clear();
  for (std::size_t r = 0; r < n; ++r) {
    int parity = 0;
    for (const int c : level.place[r]) parity ^= c & 1;
    level.colored[parity].push_back(static_cast<int>(r));
  }
}

template <int D>
void Multigrid<D>::build_structure(const Grid<D>& grid, const PressureSystem<D>& m) {
  cells_ = m.cell;
  levels_.assign(1, {});
  Level& fine = levels_[0];
  const int n = static_cast<int>(m.cell.size());
  fine.rows.resize(n);
  for (const int cell : m.cell) fine.place.push_back(grid.cell(cell));
  finish_level(fine);
  while (levels_.back().rows.size() > kFewRows) {
    Level coarse;
    coarsen(levels_.back(), coarse);
    finish_level(coarse);
    const bool stuck = coarse.rows.size() == levels_.back().rows.size();
    if (stuck) break;
    levels_.push_back(std::move(coarse));
  }
}

/// Rows of the cubes that hold rows of `fine`, in the order of their first.
template <int D>
void Multigrid<D>::coarsen(Level& fine, Level& coarse) {
  Cell<D> low = fine.place[0], high = low;
  for (const Cell<D>& c : fine.place)
    for (int d = 0; d < D; ++d) low[d] = std::min(low[d], c[d] >> 1), high[d] = std::max(high[d], c[d] >> 1);
  std::size_t size = 1;
  for (int d = 0; d < D; ++d) size *= high[d] - low[d] + 1;
  const auto slot = [&](const Cell<D>& c) {
    std::size_t i = 0;
    for (int d = D - 1; d >= 0; --d) i = i * (high[d] - low[d] + 1) + (c[d] - low[d]);
    return i;
  };
  std::vector<int> row_at(size, -1);
  fine.parent.resize(fine.rows.size());
  for (std::size_t r = 0; r < fine.rows.size(); ++r) {
    Cell<D> c;
    int child = 0;
    for (int d = 0; d < D; ++d) c[d] = fine.place[r][d] >> 1, child |= (fine.place[r][d] & 1) << d;
    int& row = row_at[slot(c)];
    if (row < 0) {
      row = static_cast<int>(coarse.place.size());
      coarse.place.push_back(c);
      coarse.children.push_back({});
      coarse.children.back().fill(-1);
    }
    coarse.children[row][child] = static_cast<int>(r);
    fine.parent[r] = row;
  }
  const int n = static_cast<int>(coarse.place.size());
  coarse.rows.resize(n);
  for (int r = 0; r < n; ++r)
    for (int d = 0; d < D; ++d)
      for (const int side : {0, 1}) {
        Cell<D> c = coarse.place[r];
        c[d] += 2 * side - 1;
        const bool inside = c[d] >= low[d] && c[d] <= high[d];
        const int other = inside ? row_at[slot(c)] : -1;
        coarse.rows[r].neighbor[2 * d + side] = other >= 0 ? other : n;
      }
}

template <int D>
void Multigrid<D>::fill_coarse(const Level& fine, Level& coarse) {
  for_chunks(coarse.rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      Row& row = coarse.rows[r];
      row.beta.fill(0);
      double own = 0;  // storage and surface
      for (const int child : coarse.children[r]) {
        if (child < 0) continue;
        const Row& f = fine.rows[child];
        own += f.diagonal;
        for (int k = 0; k < kSides; ++k) {
          own -= f.beta[k];
          const bool outward = (fine.place[child][k / 2] & 1) == (k & 1);
          if (outward) row.beta[k] += 0.5 * f.beta[k];
        }
      }
      row.diagonal = std::max(own, 0.0);
      for (const double beta : row.beta) row.diagonal += beta;
      row.inverse = row.diagonal > 0 ? 1 / row.diagonal : 0;
    }
  });
}

template <int D>
void Multigrid<D>::build(const Grid<D>& grid, const PressureSystem<D>& m) {
  if (levels_.empty() || m.cell != cells_) build_structure(grid, m);
  Level& fine = levels_[0];
  const int none = static_cast<int>(fine.rows.size());
  for_chunks(fine.rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      Row& row = fine.rows[r];
      row.diagonal = m.diagonal[r];
      row.inverse = 1 / m.diagonal[r];
      for (int d = 0; d < D; ++d) {  // gates part and join the same cells
        const int lower = m.lower[d][r], upper = m.upper[d][r];
        row.neighbor[2 * d] = lower >= 0 ? lower : none;
        row.neighbor[2 * d + 1] = upper >= 0 ? upper : none;
        row.beta[2 * d] = lower >= 0 ? -m.coupling[d][lower] : 0;
        row.beta[2 * d + 1] = -m.coupling[d][r];
      }
    }
  });
  for (std::size_t k = 1; k < levels_.size(); ++k) fill_coarse(levels_[k - 1], levels_[k]);
}

template <int D>
void Multigrid<D>::multiply(const std::vector<double>& x, std::vector<double>& y) const {
  const Level& fine = levels_[0];
  const std::size_t n = fine.rows.size();
  for_chunks(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const Row& row = fine.rows[r];
      double t = row.diagonal * x[r];
      for (int k = 0; k < kSides; ++k) t -= row.beta[k] * x[row.neighbor[k]];
      y[r] = t;
    }
  });
}

/// Sets the rows of a colour to what their neighbours ask for. `from_zero`: these are still zero.
template <int D>
void Multigrid<D>::relax(Level& level, int color, bool from_zero) {
  const std::vector<int>& rows = level.colored[color];
  for_chunks(rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int r = rows[i];
      const Row& row = level.rows[r];
      double t = level.b[r];
      if (!from_zero)
        for (int k = 0; k < kSides; ++k) t += row.beta[k] * level.x[row.neighbor[k]];
      level.x[r] = t * row.inverse;
    }
  });
}

template <int D>
void Multigrid<D>::cycle(std::size_t k) {
  Level& level = levels_[k];
  if (k + 1 == levels_.size()) {
    std::fill(level.x.begin(), level.x.end(), 0);
    for (int i = 0; i < kLastSweeps; ++i) relax(level, 0, false), relax(level, 1, false);
    for (int i = 0; i < kLastSweeps; ++i) relax(level, 1, false), relax(level, 0, false);
    return;
  }
  relax(level, 0, true), relax(level, 1, false);
  Level& coarse = levels_[k + 1];
  // Of the colour relaxed last nothing is left over.
  for_chunks(coarse.rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      double sum = 0;
      for (const int child : coarse.children[r]) {
        if (child < 0) continue;
        int parity = 0;
        for (const int c : level.place[child]) parity ^= c & 1;
        if (parity) continue;
        const Row& row = level.rows[child];
        sum += level.b[child] - row.diagonal * level.x[child];
        for (int s = 0; s < kSides; ++s) sum += row.beta[s] * level.x[row.neighbor[s]];
      }
      coarse.b[r] = sum;
    }
  });
  cycle(k + 1);
  for_chunks(level.rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) level.x[r] += coarse.x[level.parent[r]];
  });
  relax(level, 1, false), relax(level, 0, false);
}

template <int D>
void Multigrid<D>::apply(const std::vector<double>& in, std::vector<double>& out) {
  Level& fine = levels_[0];
  std::copy(in.begin(), in.begin() + static_cast<long>(fine.rows.size()), fine.b.begin());
  cycle(0);
  std::copy(fine.x.begin(), fine.x.end(), out.begin());
}

template <int D>
double Multigrid<D>::bytes() const {
  std::size_t sum = cells_.capacity() * sizeof(int);
  for (const Level& l : levels_) {
    sum += l.rows.capacity() * sizeof(Row) + l.place.capacity() * sizeof(Cell<D>) +
           l.children.capacity() * sizeof(l.children[0]) + (l.x.capacity() + l.b.capacity()) * sizeof(double);
    for (const auto* of_rows : {&l.colored[0], &l.colored[1], &l.parent})
      sum += of_rows->capacity() * sizeof(int);
  }
  return static_cast<double>(sum);
}

template class Multigrid<2>;
template class Multigrid<3>;

}  // namespace quicksand

#include "engine/step/multigrid.hpp"

#include <algorithm>

#include "engine/grid/lanes.hpp"
#include "engine/step/norms.hpp"
#include "engine/threads/chunks.hpp"

namespace quicksand {
namespace {

/// Of the last level, forward and backward.
constexpr int kLastSweeps = 4;
/// Coarse levels of no more rows are gone through once.
constexpr std::size_t kOnce = 1000;

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

/// f(run) for the runs of a colour.
template <int D>
template <class F>
void Multigrid<D>::for_runs(const Level& level, int color, F&& f) {
  const int first = color ? level.odd_part : 0,
            parts = (color ? static_cast<int>(level.parts.size()) - 1 : level.odd_part) - first;
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (int i = level.parts[first + begin]; i < level.parts[first + end]; ++i) f(level.runs[i]);
  };
  if (parts < 3)
    some(0, parts);
  else
    parallel_parts(parts, 1, some);
}

/// Σ f(run) over all runs, part by part.
template <int D>
template <class F>
double Multigrid<D>::sum_runs(const Level& level, F&& f) {
  const std::size_t parts = level.parts.size() - 1;
  std::vector<double> sums(parts);
  const auto some = [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part)
      for (int i = level.parts[part]; i < level.parts[part + 1]; ++i) sums[part] += f(level.runs[i]);
  };
  if (parts < 3)
    some(0, parts);
  else
    parallel_parts(parts, 1, some);
  double sum = 0;
  for (const double s : sums) sum += s;
  return sum;
}

template <int D>
void Multigrid<D>::fill_coarse(const Level& fine, Level& coarse) {
  const Stencil<D>& from = *fine.matrix;
  constexpr std::size_t kSome = 256;  // rows that are worth a thread
  parallel_parts(coarse.rows(), kSome, [&](std::size_t begin, std::size_t end) {
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
  if (levels_.empty() || m.changed) build_structure(grid, m);
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
double Multigrid<D>::multiply(const std::vector<double>& x, std::vector<double>& y) const {
  const Level& fine = levels_[0];
  return sum_runs(fine, [&](const Run& run) {
    const Sides<kSides> sides(*fine.matrix, run, x.data());
    const double *diagonal = fine.matrix->diagonal.data() + run.first, *own = x.data() + run.first;
    double* __restrict out = y.data() + run.first;
    for (int i = 0; i < run.count; ++i) out[i] = diagonal[i] * own[i] - sides.sum(i);
    return lanes_dot(run.count, own, out);
  });
}

/// Sets the rows of a colour to what their neighbours ask for.
template <int D>
void Multigrid<D>::relax(Level& level, int color) {
  for_runs(level, color, [&](const Run& run) {
    const Sides<kSides> sides(*level.matrix, run, level.x.data());
    const double *b = level.b.data() + run.first, *inverse = level.inverse.data() + run.first;
    double* x = level.x.data() + run.first;
    // Neighbours are of the other colour, or the row itself times 0.
    QUICKSAND_INDEPENDENT for (int i = 0; i < run.count; ++i) x[i] = (b[i] + sides.sum(i)) * inverse[i];
  });
}

/// What `relax` makes of some even rows where all x are zero still; others stay zero.
template <int D>
void Multigrid<D>::start(Level& level, std::size_t begin, std::size_t end) {
  const std::size_t middle = std::clamp<std::size_t>(level.even, begin, end);
  for (std::size_t r = begin; r < middle; ++r) level.x[r] = level.b[r] * level.inverse[r];
  for (std::size_t r = middle; r < end; ++r) level.x[r] = 0;
}

/// b − A x, of which odd rows have nothing, as they were relaxed last. The coarse level starts with it.
template <int D>
void Multigrid<D>::restrict_to(Level& coarse, Level& fine) {
  for_runs(fine, 0, [&](const Run& run) {
    const Sides<kSides> sides(*fine.matrix, run, fine.x.data());
    double* __restrict left = fine.left.data() + run.first;
    const double *b = fine.b.data() + run.first, *diagonal = fine.matrix->diagonal.data() + run.first,
                 *x = fine.x.data() + run.first;
    for (int i = 0; i < run.count; ++i) left[i] = b[i] - diagonal[i] * x[i] + sides.sum(i);
  });
  for_chunks(coarse.rows(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      double sum = 0;
      for (const int child : coarse.children[r])
        if (child >= 0 && child < fine.even) sum += fine.left[child];
      coarse.b[r] = sum;
    }
    start(coarse, begin, end);
  });
}

template <int D>
void Multigrid<D>::solve_last(Level& level) {
  relax(level, 1);
  for (int i = 1; i < kLastSweeps; ++i) relax(level, 0), relax(level, 1);
  for (int i = 0; i < kLastSweeps; ++i) relax(level, 1), relax(level, 0);
}

/// On a level that has started. Coarse levels of many rows are gone through twice: with prolongation by
/// copies one pass solves them too badly for the level above.
template <int D>
void Multigrid<D>::cycle(std::size_t k) {
  Level& level = levels_[k];
  if (k + 1 == levels_.size()) return solve_last(level);
  Level& coarse = levels_[k + 1];
  const int times = k > 0 && level.rows() > kOnce ? 2 : 1;
  for (int time = 0; time < times;
       ++time) {  // even rows are relaxed: at the start, and at the end of the first
    relax(level, 1);
    restrict_to(coarse, level);
    cycle(k + 1);
    for_chunks(level.even, [&](std::size_t begin, std::size_t end) {  // odd rows follow from these
      for (std::size_t r = begin; r < end; ++r) level.x[r] += coarse.x[level.parent[r]];
    });
    relax(level, 1), relax(level, 0);
  }
}

template <int D>
double Multigrid<D>::apply(std::vector<double>& in, std::vector<double>& out) {
  Level& fine = levels_[0];
  std::swap(fine.b, in), std::swap(fine.x, out);
  for_chunks(fine.rows(), [&](std::size_t begin, std::size_t end) { start(fine, begin, end); });
  cycle(0);
  const double product = dot(fine.rows(), fine.b, fine.x);
  std::swap(fine.b, in), std::swap(fine.x, out);
  return product;
}

template <int D>
double Multigrid<D>::bytes() const {
  std::size_t sum = 0;
  for (const Level& l : levels_) {
    for (const auto* v : {&l.inverse, &l.x, &l.b, &l.left, &l.own.diagonal})
      sum += v->capacity() * sizeof(double);
    for (const auto& side : l.own.coupling) sum += side.capacity() * sizeof(double);
    sum += l.runs.capacity() * sizeof(Run) + l.parent.capacity() * sizeof(int) +
           l.children.capacity() * sizeof(l.children[0]);
  }
  return static_cast<double>(sum);
}

template class Multigrid<2>;
template class Multigrid<3>;

}  // namespace quicksand

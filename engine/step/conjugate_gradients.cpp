#include "engine/step/conjugate_gradients.hpp"

#include <cmath>

#include "engine/threads/chunks.hpp"

namespace quicksand {
namespace {

/// Largest magnitude; not a number if one is.
template <class F>
double largest(std::size_t n, F&& f) {
  const auto larger = [](double a, double b) { return b > a || std::isnan(b) ? b : a; };
  const auto part = [&](std::size_t begin, std::size_t end) {
    double m = 0;
    for (std::size_t i = begin; i < end; ++i) m = larger(m, std::abs(f(i)));
    return m;
  };
  return reduce_chunks(n, 0.0, part, larger);
}

double dot(std::size_t n, const std::vector<double>& a, const std::vector<double>& b) {
  const auto part = [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += a[i] * b[i];
    return sum;
  };
  return reduce_chunks(n, 0.0, part, [](double x, double y) { return x + y; });
}

template <int D>
void add_pistons(const PressureSystem<D>& m, const std::vector<double>& x, std::vector<double>& y) {
  for (const auto& piston : m.pistons) {
    double sum = 0;
    for (std::size_t k = 0; k < piston.row.size(); ++k) sum += piston.weight[k] * x[piston.row[k]];
    for (std::size_t k = 0; k < piston.row.size(); ++k)
      y[piston.row[k]] += piston.response * piston.weight[k] * sum;
  }
}

/// Size of the terms that cancel in a row, times rounding: no residual can be asked to be smaller.
constexpr double kRounding = 1e-15;

}  // namespace

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
  add_pistons(m, x, y);
}

template <int D>
PressureReport conjugate_gradients(const Grid<D>& grid, PressureSystem<D>& m, Multigrid<D>& multigrid,
                                   double tolerance) {
  constexpr int kMaxIterations = 2000;
  const std::size_t rows = m.cell.size();
  PressureReport report{static_cast<int>(rows)};
  std::vector<double>&x = m.work.x, &r = m.work.residual, &z = m.work.preconditioned;
  std::vector<double>&direction = m.work.direction, &image = m.work.image;
  for (std::vector<double>* v : {&x, &r, &z, &direction, &image}) v->resize(rows + 1), v->back() = 0;
  std::copy(m.solution.begin(), m.solution.end(), x.begin());
  multigrid.build(grid, m);
  const auto times = [&](const std::vector<double>& in, std::vector<double>& out) {
    multigrid.multiply(in, out);
    add_pistons(m, in, out);
  };
  times(x, image);
  for_chunks(rows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) r[i] = m.rhs[i] - image[i];
  });
  const double scale = largest(rows, [&](std::size_t i) { return m.rhs[i]; });
  const double term = largest(rows, [&](std::size_t i) { return m.diagonal[i] * m.solution[i]; });
  const double target = tolerance * scale + kRounding * term;
  const auto residual_of = [&] { return largest(rows, [&](std::size_t i) { return r[i]; }); };
  double residual = residual_of();
  const auto go = [&](double alpha) {
    for_chunks(rows, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        x[i] += alpha * direction[i];
        r[i] -= alpha * image[i];
      }
    });
    residual = residual_of();
  };
  if (residual > target && !m.change.empty()) {
    std::copy(m.change.begin(), m.change.end(), direction.begin());
    times(direction, image);
    const double energy = dot(rows, direction, image);
    if (energy > 0) go(dot(rows, direction, r) / energy);
  }
  double rz = 0;
  while (residual > target && report.iterations < kMaxIterations) {
    multigrid.apply(r, z);
    const double next = dot(rows, r, z), turn = report.iterations ? next / rz : 0;
    rz = next;
    for_chunks(rows, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) direction[i] = turn == 0 ? z[i] : z[i] + turn * direction[i];
    });
    times(direction, image);
    go(rz / dot(rows, direction, image));
    ++report.iterations;
  }
  std::copy(x.begin(), x.end() - 1, m.solution.begin());
  report.residual = scale > 0 ? residual / scale : 0;
  report.converged = residual <= target;
  return report;
}

template void multiply<2>(const PressureSystem<2>&, const std::vector<double>&, std::vector<double>&);
template void multiply<3>(const PressureSystem<3>&, const std::vector<double>&, std::vector<double>&);
template PressureReport conjugate_gradients<2>(const Grid<2>&, PressureSystem<2>&, Multigrid<2>&, double);
template PressureReport conjugate_gradients<3>(const Grid<3>&, PressureSystem<3>&, Multigrid<3>&, double);

}  // namespace quicksand

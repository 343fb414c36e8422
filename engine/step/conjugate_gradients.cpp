#include "engine/step/conjugate_gradients.hpp"

#include <cmath>

#include "engine/step/norms.hpp"

namespace quicksand {
namespace {

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
    double t = m.matrix.diagonal[r] * x[r];
    for (int k = 0; k < 2 * D; ++k)
      if (const int j = m.neighbor[k][r]; j >= 0) t -= m.matrix.coupling[k][r] * x[j];
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
  std::vector<double>&x = m.solution, &r = m.work.residual, &z = m.work.preconditioned;
  std::vector<double>&direction = m.work.direction, &image = m.work.image;
  for (std::vector<double>* v : {&r, &z, &direction, &image}) resize_with_spare(*v, rows);
  multigrid.build(grid, m);
  m.changed = false;
  const auto times = [&](const std::vector<double>& in, std::vector<double>& out) {
    const double product = multigrid.multiply(in, out);
    if (m.pistons.empty()) return product;
    add_pistons(m, in, out);
    return dot(rows, in, out);
  };
  times(x, image);
  const auto magnitude = [&](const std::vector<double>& v) {
    return largest(
        rows, [&](std::size_t i) { return lanes_from<kBatch>(v[i]); }, [&](std::size_t i) { return v[i]; });
  };
  const std::vector<double>& diagonal = m.matrix.diagonal;
  const double term = largest(
      rows, [&](std::size_t i) { return lanes_from<kBatch>(diagonal[i]) * lanes_from<kBatch>(x[i]); },
      [&](std::size_t i) { return diagonal[i] * x[i]; });
  const double scale = magnitude(m.rhs);
  const double target = tolerance * scale + kRounding * term;
  for_chunks(rows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) r[i] = m.rhs[i] - image[i];
  });
  double residual = magnitude(r);
  const auto go = [&](const std::vector<double>& along, double alpha) {
    residual = largest(
        rows,
        [&](std::size_t i) {
          put_lanes<kBatch>(x[i], lanes_from<kBatch>(x[i]) + alpha * lanes_from<kBatch>(along[i]));
          const BatchLanes left = lanes_from<kBatch>(r[i]) - alpha * lanes_from<kBatch>(image[i]);
          put_lanes<kBatch>(r[i], left);
          return left;
        },
        [&](std::size_t i) {
          x[i] += alpha * along[i];
          return r[i] -= alpha * image[i];
        });
  };
  if (residual > target && !m.change.empty()) {
    const double energy = times(m.change, image);
    if (energy > 0) go(m.change, dot(rows, m.change, r) / energy);
  }
  double rz = 0;
  while (residual > target && report.iterations < kMaxIterations) {
    const double next = multigrid.apply(r, z), turn = report.iterations ? next / rz : 0;
    rz = next;
    for_chunks(rows, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) direction[i] = turn == 0 ? z[i] : z[i] + turn * direction[i];
    });
    const double energy = times(direction, image);
    go(direction, rz / energy);
    ++report.iterations;
  }
  report.residual = scale > 0 ? residual / scale : 0;
  report.converged = residual <= target;
  return report;
}

template void multiply<2>(const PressureSystem<2>&, const std::vector<double>&, std::vector<double>&);
template void multiply<3>(const PressureSystem<3>&, const std::vector<double>&, std::vector<double>&);
template PressureReport conjugate_gradients<2>(const Grid<2>&, PressureSystem<2>&, Multigrid<2>&, double);
template PressureReport conjugate_gradients<3>(const Grid<3>&, PressureSystem<3>&, Multigrid<3>&, double);

}  // namespace quicksand

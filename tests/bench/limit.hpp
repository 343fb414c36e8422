#pragma once
// The least that a step of this method has to do per point, whatever the program: what the machine's limit is
// divided by. Counted for quadratic kernels on a staggered grid, two passes over the points (to the grid;
// back from it), double precision. Grid, pressure and output are not in it, so no step can reach the limit.

#include <benchmark/benchmark.h>

#include "engine/grid/walls.hpp"
#include "engine/points/points.hpp"
#include "tests/bench/scenes.hpp"

namespace quicksand::bench {

struct LeastWork {
  double bytes = 0;  ///< between memory and core, per point-step
  double flops = 0;
};

/// Arithmetic of the kernels of a point: the D components and the cell's centre, 3^D places each.
template <int D>
constexpr double kernel_flops() {
  constexpr double kPlaces = power(3, D);
  constexpr double kSpline = 12;           // 3 values and 3 slopes, along one axis
  const double splines = D * 2 * kSpline;  // about faces and about centres
  const double products = (D + 1) * kPlaces * (D - 1);
  return splines + products;
}

/// A point of soil: position, velocity, mass, porosity, stress, plastic strain and material are read on the
/// way to the grid (but the strain) and on the way back; position, velocity, porosity, stress and strain
/// written.
template <int D>
constexpr LeastWork soil_work() {
  constexpr double kPlaces = power(3, D), kReal = sizeof(double), kIndex = sizeof(std::int32_t);
  const double moving = (2 * D + 1 + kStress<D>)*kReal;  // x, v, n, σ′
  const double bytes = (moving + kReal + kIndex) + (moving + 2 * kReal + kIndex) + (moving + kReal);
  const double slopes = D * kPlaces * D * (D - 1);
  const double to_faces = D * kPlaces * (2 * 5 + 2 * D);  // mass, volumes, momentum, drag; ∇·σ′
  const double to_cells = kPlaces * 2 * 2;
  const double back = D * kPlaces * (2 * 2 + 2 * D);  // old and new velocity, its gradient
  const double law = D == 2 ? 100 : 200;              // elastic predictor and the check of the yield surface
  return {bytes, kernel_flops<D>() + slopes + to_faces + to_cells + back + law};
}

/// A point of water: position, velocity and mass are read twice (mass once); position and velocity written.
template <int D>
constexpr LeastWork water_work() {
  constexpr double kPlaces = power(3, D), kReal = sizeof(double);
  const double bytes = (2 * D + 1) * kReal + 2 * (2 * D) * kReal;
  return {bytes, kernel_flops<D>() + D * kPlaces * 2 * 2 + kPlaces * 2 + D * kPlaces * 2 * 2};
}

/// Part of a scene's points that are soil.
inline double soil_part(Kind kind) { return kind == Kind::bed ? 0.4 : kind == Kind::column ? 1 : 0; }

template <int D>
LeastWork least_work(Kind kind) {
  const double soil = soil_part(kind);
  const LeastWork s = soil_work<D>(), w = water_work<D>();
  return {soil * s.bytes + (1 - soil) * w.bytes, soil * s.flops + (1 - soil) * w.flops};
}

inline void report_least_work(benchmark::State& state, Kind kind, int dimensions) {
  const LeastWork least = dimensions == 2 ? least_work<2>(kind) : least_work<3>(kind);
  state.counters["least_bytes"] = least.bytes;
  state.counters["least_flops"] = least.flops;
}

}  // namespace quicksand::bench

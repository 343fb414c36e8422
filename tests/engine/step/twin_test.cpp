// The passes over points, which take rows of nodes and some points at once, against the same point by point
// and node by node, in doubles alone.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/step/move_point.hpp"
#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

constexpr double kStep = 1e-2;   // s
constexpr double kSpeed = 0.05;  // m/s, of points and faces

struct Disturbance {
  std::mt19937 random{5};
  double operator()(double most) { return std::uniform_real_distribution<double>(-most, most)(random); }
};

/// A state whose points have left their lattice, with any velocities and stresses.
template <int D>
State<D> disturbed(const Scene& scene, Disturbance& any) {
  State<D> s = make_state<D>(scene);
  const auto disturb = [&](auto& set) {
    for (std::size_t p = 0; p < set.size(); ++p)
      for (int d = 0; d < D; ++d) set.v[p][d] = any(kSpeed), set.x[p][d] += any(0.2 * s.grid.h);
    for (auto& gradient : set.affine)
      for (auto& row : gradient)
        for (double& entry : row) entry = any(1);
  };
  disturb(s.soil), disturb(s.water);
  EXPECT_GT(s.soil.size() + s.water.size(), 100u);
  for (auto& stress : s.soil.stress)
    for (double& component : stress) component = any(1e3);
  return s;
}

/// What points_to_faces leaves.
template <int D>
struct Left {
  std::array<std::vector<FaceSums>, D> sums;
  std::array<std::vector<FaceImage>, D> image;
  std::vector<CellSums> cells;
  explicit Left(int count) : cells(count) {
    for (int d = 0; d < D; ++d) sums[d].resize(count), image[d].resize(count);
  }
};

/// Momentum of a point that one of its faces takes.
template <int D>
double carried(const PointSet<D>& set, std::size_t p, int d, const FaceWeight<D>& f) {
  double v = set.v[p][d];
  if (!set.affine.empty())
    for (int j = 0; j < D; ++j) v += set.affine[p][d][j] * f.arm[j];
  return f.w * set.mass[p] * v;
}

template <class Shape, int D>
void soil_leaves(const State<D>& s, std::size_t p, Left<D>& left) {
  constexpr int entry[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  const PointKernel<D, Shape> kernel(s.grid, s.soil.x[p]);
  const SoilMaterial& soil = s.constants.soils[s.soil.soil[p]];
  const double mass = s.soil.mass[p], grains = mass / soil.grain_density,
               bulk = grains / (1 - s.soil.porosity[p]);
  const Stress<D>& t = s.soil.stress[p];
  for (int d = 0; d < D; ++d)
    for_faces(s.grid, s.soil_walls, kernel, d, [&](int face, const FaceWeight<D>& f, double sign) {
      FaceSums& to = left.sums[d][face];
      to.soil_mass += f.w * mass;
      to.soil_momentum += sign * carried<D>(s.soil, p, d, f);
      for (int j = 0; j < D; ++j) to.soil_force -= sign * bulk * t[entry[d][j]] * f.gradient[j];
      if (s.grid.axial && d == 0) to.soil_force -= sign * bulk * t[2] / s.soil.x[p][0] * f.w;
      if (sign < 0) left.image[d][face].soil += 2 * f.w * mass;
      if (!s.has_water) return;
      to.grains += f.w * grains, to.soil_bulk += f.w * bulk;
      to.resistivity += f.w * bulk * soil.drag.resistivity(s.soil.porosity[p]);
    });
  if (!s.counts_room) return;
  for_centers(s.grid, s.water_walls, kernel, [&](int cell, double w) {
    left.cells[cell].grains += w * grains, left.cells[cell].soil_bulk += w * bulk;
  });
}

template <class Shape, int D>
void water_leaves(const State<D>& s, std::size_t p, Left<D>& left) {
  const PointKernel<D, Shape> kernel(s.grid, s.water.x[p]);
  const double mass = s.water.mass[p];
  for (int d = 0; d < D; ++d)
    for_faces(s.grid, s.water_walls, kernel, d, [&](int face, const FaceWeight<D>& f, double sign) {
      left.sums[d][face].water_mass += f.w * mass;
      left.sums[d][face].water_momentum += sign * carried<D>(s.water, p, d, f);
      if (sign < 0) left.image[d][face].water += 2 * f.w * mass;
    });
  for_centers(s.grid, s.water_walls, kernel,
              [&](int cell, double w) { left.cells[cell].water += w * mass / s.constants.water_density; });
}

/// Quadratic kernel: with hats, faces give what they hold to others at once.
template <int D>
void expect_same_to_faces(const Scene& scene) {
  Disturbance any;
  State<D> s = disturbed<D>(scene, any);
  points_to_faces(s);
  Left<D> left(s.grid.count());
  for (std::size_t p = 0; p < s.soil.size(); ++p) soil_leaves<QuadraticSpline>(s, p, left);
  for (std::size_t p = 0; p < s.water.size(); ++p) water_leaves<QuadraticSpline>(s, p, left);
  for (int i = 0; i < s.grid.count(); ++i) {
    for (int d = 0; d < D; ++d) {
      const FaceSums a = s.sums[d][i], b = left.sums[d][i];
      EXPECT_NEAR(a.soil_mass, b.soil_mass, 1e-12);
      EXPECT_NEAR(a.grains, b.grains, 1e-15);
      EXPECT_NEAR(a.soil_bulk, b.soil_bulk, 1e-15);
      EXPECT_NEAR(a.resistivity, b.resistivity, 1e-12 * (1 + b.resistivity));
      EXPECT_NEAR(a.soil_momentum, b.soil_momentum, 1e-12);
      EXPECT_NEAR(a.soil_force, b.soil_force, 1e-10);
      EXPECT_NEAR(a.water_mass, b.water_mass, 1e-12);
      EXPECT_NEAR(a.water_momentum, b.water_momentum, 1e-12);
      EXPECT_NEAR(s.image[d][i].soil, left.image[d][i].soil, 1e-12);
      EXPECT_NEAR(s.image[d][i].water, left.image[d][i].water, 1e-12);
    }
    EXPECT_NEAR(s.cell_sums[i].water, left.cells[i].water, 1e-15);
    EXPECT_NEAR(s.cell_sums[i].grains, left.cells[i].grains, 1e-15);
    EXPECT_NEAR(s.cell_sums[i].soil_bulk, left.cells[i].soil_bulk, 1e-15);
  }
}

/// Velocity of a phase at a point, before and after the step, and the gradients of the latter.
template <int D>
struct Felt {
  Vec<D> before{}, after{};
  Gradient<D> slope{}, affine{};  ///< 1/s
};
template <class Shape, int D, class Speeds>
Felt<D> felt(const State<D>& s, const Walls<D>& walls, const Vec<D>& x, const Speeds& speeds) {
  Felt<D> at;
  const PointKernel<D, Shape> kernel(s.grid, x);
  for (int d = 0; d < D; ++d)
    for_faces(s.grid, walls, kernel, d, [&](int face, const FaceWeight<D>& f, double sign) {
      const auto [old, now] = speeds(s.speeds[d][face]);
      at.before[d] += sign * f.w * old, at.after[d] += sign * f.w * now;
      const Vec<D> turning = affine_weight<Shape>(f, s.grid.inverse_h);
      for (int j = 0; j < D; ++j) {
        at.slope[d][j] += sign * now * f.gradient[j];
        at.affine[d][j] += sign * now * turning[j];
      }
    });
  return at;
}

template <int D>
Vec<D> expected_velocity(const Vec<D>& v, const Felt<D>& at, double pic) {
  Vec<D> out;
  for (int d = 0; d < D; ++d) out[d] = (1 - pic) * (v[d] + at.after[d] - at.before[d]) + pic * at.after[d];
  return out;
}
template <int D>
Vec<D> expected_place(const State<D>& s, const Walls<D>& walls, Vec<D> x, const Vec<D>& v, double dt) {
  Vec<D> way;
  for (int d = 0; d < D; ++d) way[d] = dt * v[d];
  move_point<D>(s.grid, walls, s.grid.index(s.grid.cell_of(x)), x, way);
  return x;
}
template <int D>
void expect_same_vectors(const Vec<D>& a, const Vec<D>& b) {
  for (int d = 0; d < D; ++d) EXPECT_NEAR(a[d], b[d], 1e-13);
}
template <int D>
void expect_same_gradients(const PointSet<D>& set, std::size_t p, const Gradient<D>& expected) {
  if (set.affine.empty()) return;
  for (int d = 0; d < D; ++d)
    for (int j = 0; j < D; ++j) EXPECT_NEAR(set.affine[p][d][j], expected[d][j], 1e-12);
}

template <class Shape, int D>
void expect_same_soil(const State<D>& s, const State<D>& after, std::size_t p, double pic) {
  const SoilPoints<D>&old = s.soil, &now = after.soil;
  const Felt<D> at = felt<Shape, D>(s, s.soil_walls, old.x[p], [](const FaceSpeeds& f) {
    return std::pair{f.soil_old, f.soil};
  });
  expect_same_vectors<D>(now.v[p], expected_velocity<D>(old.v[p], at, pic));
  expect_same_vectors<D>(now.x[p], expected_place<D>(s, s.soil_walls, old.x[p], at.after, kStep));
  expect_same_gradients<D>(now, p, at.affine);
  const double hoop = s.grid.axial ? at.after[0] / old.x[p][0] : 0;
  const double stretch = volume_ratio<D, double>(at.slope, kStep) * (1 + kStep * hoop);
  EXPECT_NEAR(now.porosity[p], 1 - (1 - old.porosity[p]) / stretch, 1e-13);
  SoilState<D> state = soil_state(old, p);
  update_state<D>(s.constants.soils[old.soil[p]], state, old.porosity[p], at.slope, kStep, hoop);
  for (int i = 0; i < kStress<D>; ++i) EXPECT_NEAR(now.stress[p][i], state.stress[i], 1e-7);
  EXPECT_NEAR(now.plastic_strain[p], state.plastic_strain, 1e-13);
}

/// Below a surface: drops above it fall freely.
template <class Shape, int D>
void expect_same_water(const State<D>& s, const State<D>& after, std::size_t p, double pic) {
  const WaterPoints<D>&old = s.water, &now = after.water;
  const auto water = [](const FaceSpeeds& f) { return std::pair{f.water_old, f.water}; };
  const Felt<D> at = felt<Shape, D>(s, s.water_walls, old.x[p], water);
  expect_same_vectors<D>(now.v[p], expected_velocity<D>(old.v[p], at, pic));
  expect_same_gradients<D>(now, p, at.affine);
  const Vec<D> middle = expected_place<D>(s, s.water_walls, old.x[p], at.after, 0.5 * kStep);
  const Felt<D> there = felt<typename Shape::Mover, D>(s, s.water_walls, middle, water);
  expect_same_vectors<D>(now.x[p], expected_place<D>(s, s.water_walls, old.x[p], there.after, kStep));
}

/// Any velocities on the faces.
template <int D>
void expect_same_to_points(const Scene& scene) {
  Disturbance any;
  State<D> s = disturbed<D>(scene, any);
  points_to_faces(s);
  find_surface(s);
  for (int d = 0; d < D; ++d)
    for (auto& f : s.speeds[d])
      f.soil_old = any(kSpeed), f.soil = any(kSpeed), f.water_old = any(kSpeed), f.water = any(kSpeed);
  State<D> after = s;
  StepReport<D> report;
  faces_to_points(after, kStep, report);
  const double pic =
      scene.numerics.transfer == Transfer::apic ? 1 : 1 - std::exp(-s.constants.pic_rate * kStep);
  with_kernel(s.constants.kernel, [&](auto shape) {
    for (std::size_t p = 0; p < s.soil.size(); ++p) expect_same_soil<decltype(shape)>(s, after, p, pic);
    for (std::size_t p = 0; p < s.water.size(); ++p) expect_same_water<decltype(shape)>(s, after, p, pic);
  });
}

/// f(scene) for what fills a corner of its domain, or all of it, in the plane, about an axis and in space.
template <class F>
void for_scenes(BodyKind kind, const Vec3& part, const Numerics& numerics, F&& f) {
  const auto with_body = [&](Scene s) {
    const Vec3& all = s.domain.max;
    add_body(s, "body", kind, {0, 0, 0}, {part[0] * all[0], part[1] * all[1], part[2] * all[2]});
    s.numerics.kernel = numerics.kernel, s.numerics.transfer = numerics.transfer;
    return s;
  };
  Scene axial = plane(1, 1, 0.1);
  axial.domain.dimension = Dimension::axisymmetric;
  f(with_body(plane(1, 1, 0.1)), std::integral_constant<int, 2>{});
  f(with_body(axial), std::integral_constant<int, 2>{});
  f(with_body(space({0.8, 0.8, 0.8}, 0.1)), std::integral_constant<int, 3>{});
}
template <class F>
void for_kinds(F&& f) {
  for (const BodyKind kind : {BodyKind::saturated_soil, BodyKind::soil, BodyKind::water}) {
    SCOPED_TRACE("body " + std::to_string(static_cast<int>(kind)));
    for (const Transfer transfer : {Transfer::flip, Transfer::apic}) {
      SCOPED_TRACE("transfer " + std::to_string(static_cast<int>(transfer)));
      f(kind, transfer);
    }
  }
}

TEST(Twin, PointsLeaveTheSameOnFaces) {
  for_kinds([](BodyKind kind, Transfer transfer) {
    Numerics numerics;
    numerics.transfer = transfer;
    for_scenes(kind, {0.7, 0.6, 1}, numerics,
               [](const Scene& scene, auto D) { expect_same_to_faces<D>(scene); });
  });
}

TEST(Twin, PointsTakeTheSameFromFaces) {
  for (const Kernel kernel : {Kernel::quadratic, Kernel::linear}) {
    SCOPED_TRACE("kernel " + std::to_string(static_cast<int>(kernel)));
    for_kinds([&](BodyKind kind, Transfer transfer) {
      Numerics numerics;
      numerics.kernel = kernel, numerics.transfer = transfer;
      const Vec3 part = kind == BodyKind::soil ? Vec3{0.7, 0.6, 1} : Vec3{1, 1, 1};
      for_scenes(kind, part, numerics, [](const Scene& scene, auto D) { expect_same_to_points<D>(scene); });
    });
  }
}

}  // namespace
}  // namespace quicksand

// Soil points updated in lanes end where they end alone, whichever way back from beyond yield they take.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <random>

#include "engine/materials/principal_lanes.hpp"
#include "engine/materials/soil_material.hpp"

namespace quicksand {
namespace {

SoilMaterial material(const SoilModel& model) {
  Soil soil;
  soil.model = model;
  return SoilMaterial::from(soil, Water{});
}

constexpr double kStep = 1e-3;  // s
std::mt19937 random_numbers(7);
double any(double reach) { return std::uniform_real_distribution<double>(-reach, reach)(random_numbers); }

/// A stress of which some components are zero or equal, as in soil at rest.
template <int D>
SoilState<D> some_state(int kind) {
  SoilState<D> state;
  for (std::size_t i = 0; i < state.stress.size(); ++i)
    state.stress[i] = i < 3 ? -5e4 + any(4e4) : kind == 0 ? 0 : any(2e4);
  if (kind == 0) state.stress[2] = state.stress[0];
  if (kind == 1) state.stress = {};
  state.plastic_strain = std::abs(any(0.05));
  state.preconsolidation = 2e5;
  return state;
}

template <int D>
void expect_lanes_agree(const std::array<SoilMaterial, 2>& soils, double rate) {
  int yielded = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::array<const SoilMaterial*, kBatch> soil;
    std::array<SoilState<D>, kBatch> alone;
    SoilState<D, BatchLanes> lanes;
    Gradient<D, BatchLanes> l;
    BatchLanes n;
    const int count = 1 + trial % kBatch;
    for (int k = 0; k < kBatch; ++k) {
      soil[k] = &soils[trial % 3 == 0 ? k % 2 : 0];
      alone[k] = some_state<D>(trial % 4);
      set_lane(lanes, k, alone[k]);
      set_lane(n, k, 0.4 + any(0.05));
      Gradient<D> gradient;
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) set_lane(l[i][j], k, gradient[i][j] = any(rate));
      if (k < count) update_state<D>(*soil[k], alone[k], n[k], gradient, kStep);
    }
    update_states<D>(soil, count, lanes, n, l, kStep, BatchLanes{});
    for (int k = 0; k < count; ++k) {
      const SoilState<D> one = lane_of(lanes, k);
      double size = 1e3;
      for (const double c : alone[k].stress) size = std::max(size, std::abs(c));
      for (std::size_t i = 0; i < one.stress.size(); ++i)
        ASSERT_NEAR(one.stress[i], alone[k].stress[i], 1e-9 * size) << "trial " << trial << " lane " << k;
      ASSERT_NEAR(one.plastic_strain, alone[k].plastic_strain, 1e-10);
      ASSERT_NEAR(one.preconsolidation, alone[k].preconsolidation, 1e-6);
      yielded += one.plastic_strain > 0.051;
    }
  }
  if (rate > 1) {
    EXPECT_GT(yielded, 100);
  }
}

TEST(Batch, LanesEndWherePointsAloneDo) {
  SoilModel sand{
      .law = SoilLaw::mohr_coulomb, .young_modulus = 1e7, .poisson_ratio = 0.3, .friction_angle = 30};
  sand.dilation_angle = 5;
  SoilModel clay = sand;
  clay.friction_angle = 20, clay.dilation_angle = 0, clay.cohesion = 1e4, clay.tension_cutoff = 2e3;
  SoilModel softening = clay;
  softening.residual_cohesion = 1e3, softening.softening_strain = 0.04;
  SoilModel undrained = clay;
  undrained.friction_angle = 0, undrained.tension_cutoff.reset();
  SoilModel elastic{.law = SoilLaw::linear_elastic, .young_modulus = 1e7, .poisson_ratio = 0.3};
  for (const double rate : {0.01, 30.0})
    for (const auto& [a, b] :
         {std::pair{sand, clay}, {softening, sand}, {undrained, elastic}, {clay, undrained}}) {
      expect_lanes_agree<2>({material(a), material(b)}, rate);
      expect_lanes_agree<3>({material(a), material(b)}, rate);
    }
}

/// Tensors of all sizes, some with zeros, with two values that are nearly or fully one, or with all three.
Stress<3, BatchLanes> some_tensors(int trial) {
  Stress<3, BatchLanes> s;
  for (auto& component : s)
    for (int k = 0; k < kBatch; ++k)
      set_lane(component, k, trial % 5 == 4 && any(1) > 0 ? 0 : any(1) * std::pow(10, any(6)));
  if (trial % 7 == 0)  // squares of nothing
    for (auto& component : s) component *= 1e-170;
  if (trial % 3 == 0) s[1] = s[0];
  if (trial % 11 == 0) s[3] = s[4] = s[5] = std::pow(10, -trial % 17) * s[3];
  if (trial % 13 == 0) s[1] = s[2] = s[0];
  return s;
}
double size_of(const Stress<3>& s) {
  double size = std::numeric_limits<double>::min();
  for (const double c : s) size = std::max(size, std::abs(c));
  return size;
}
Stress<3> lane_of_tensors(const Stress<3, BatchLanes>& s, int k) {
  Stress<3> one;
  for (int i = 0; i < 6; ++i) one[i] = s[i][k];
  return one;
}

TEST(PrincipalLanes, MakeTheTensorAgain) {
  for (int trial = 0; trial < 500; ++trial) {
    const Stress<3, BatchLanes> s = some_tensors(trial);
    const PrincipalLanes<3> p(s);
    const auto again = p.with(p.value);
    for (int k = 0; k < kBatch; ++k) {
      const Stress<3> one = lane_of_tensors(s, k);
      const double size = size_of(one);
      const auto exact = principal(one).value;
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(p.value[i][k], exact[i], 1e-10 * size);
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(again[i][k], one[i], 1e-14 * size);
    }
  }
}

// As a return onto a yield surface changes them: values come closer to each other, and all of them move.
TEST(PrincipalLanes, TakeOtherValuesInTheSameDirections) {
  for (int trial = 0; trial < 2000; ++trial) {
    const Stress<3, BatchLanes> s = some_tensors(trial);
    const PrincipalLanes<3> p(s);
    const auto& [s1, s2, s3] = p.value;
    const double upper = trial % 4 == 0 ? 0 : std::abs(any(1)), lower = trial % 6 == 0 ? 0 : std::abs(any(1));
    const BatchLanes middle = any(1) * s2 + any(1) * s1;
    const auto returned = p.with({middle + upper * (s1 - s2), middle, middle - lower * (s2 - s3)});
    for (int k = 0; k < kBatch; ++k) {
      const Stress<3> one = lane_of_tensors(s, k);
      Eigen::Matrix3d tensor;
      tensor << one[0], one[3], one[5], one[3], one[1], one[4], one[5], one[4], one[2];
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> exact(tensor / size_of(one));  // ascending
      const Eigen::Vector3d value = size_of(one) * exact.eigenvalues();
      const double m = middle[k];
      const Eigen::Vector3d other(m - lower * (value[1] - value[0]), m, m + upper * (value[2] - value[1]));
      const Eigen::Matrix3d& axes = exact.eigenvectors();
      const Eigen::Matrix3d all = axes * other.asDiagonal() * axes.transpose();
      const Stress<3> expected{all(0, 0), all(1, 1), all(2, 2), all(0, 1), all(1, 2), all(2, 0)};
      for (int i = 0; i < 6; ++i) ASSERT_NEAR(returned[i][k], expected[i], 2e-13 * size_of(one)) << trial;
    }
  }
}

}  // namespace
}  // namespace quicksand

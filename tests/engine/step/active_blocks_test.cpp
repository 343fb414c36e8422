// What lies far from any point is empty, takes no time and changes nothing.

#include <gtest/gtest.h>

#include <fstream>

#include "engine/step/phases.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

Scene bank_in(double width, double height) {
  Scene s = collapse();
  s.domain.max = {width, height, 0};
  return s;
}

TEST(ActiveBlocks, AnEmptyDomainAHundredTimesLargerChangesNoBit) {
  State<2> near = make_state<2>(bank_in(2, 0.8)), far = make_state<2>(bank_in(20, 8));
  advance_times(near, 60, 5e-4), advance_times(far, 60, 5e-4);
  StepReport<2> motion;
  measure_motion(near, motion);
  ASSERT_GT(motion.max_speed, 0.05);
  EXPECT_EQ(near.soil.x, far.soil.x);
  EXPECT_EQ(near.soil.stress, far.soil.stress);
  EXPECT_EQ(near.water.x, far.water.x);
  EXPECT_EQ(near.water.v, far.water.v);
  EXPECT_EQ(near.blocks.count(), far.blocks.count());
}

TEST(ActiveBlocks, NothingIsLeftWhereThePointsHaveBeen) {
  Scene scene = plane(4, 1, 0.05);
  add_body(scene, "drop", BodyKind::water, {0.2, 0.4, 0}, {0.4, 0.6, 0});
  scene.gravity = {0, 0, 0};
  scene.bodies[0].velocity = {5, 0, 0};
  State<2> s = make_state<2>(scene);
  const int start = s.grid.index({6, 10});
  EXPECT_GT(s.cell_sums[start].water, 0);
  advance_times(s, 100, 5e-3);
  EXPECT_GT(s.water.x[0][0], 2);
  for (int i = 0; i < s.grid.count(); ++i) {
    const Cell<2> c = s.grid.cell(i);
    if (!s.grid.inside(c) || s.blocks.number_of(s.blocks.block_of(c)) >= 0) continue;
    for (int d = 0; d < 2; ++d) {
      EXPECT_EQ(s.sums[d][i].water_mass, 0);
      EXPECT_EQ(s.flow[d][i].wet, 0);
      EXPECT_EQ(s.speeds[d][i].water, 0);
    }
    EXPECT_EQ(s.cell_sums[i].water, 0);
    EXPECT_FALSE(s.cell[i].wet());
    EXPECT_EQ(s.pressure[i], 0);
  }
}

/// Bytes of this process that are in memory.
double resident() {
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * 4096;
}

TEST(Field, TakesMemoryWhereItIsTouched) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep books of memory in memory";
#endif
  constexpr std::size_t kMany = 200'000'000;
  const double before = resident();
  Field<FaceFlow> field(kMany);  // 13 GB
  field[0].phi = 1, field[kMany / 2].exchange_response = 2, field[kMany - 1].n = 3;
  EXPECT_LT(resident() - before, 1e6);
  EXPECT_EQ(field[kMany / 2].exchange_response, 2);
  EXPECT_EQ(field[kMany / 3].exchange_response, 0);
  EXPECT_EQ(field[kMany / 3].wet, 0);
}

TEST(LargeArrays, AreGivenBack) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep memory that was freed";
#endif
  std::vector<char>(30'000'000, 1).clear();
  std::vector<std::vector<char>> large, small;
  const double before = resident();
  for (int i = 0; i < 60; ++i) large.emplace_back(3'000'000, 1), small.emplace_back(50'000, 1);
  EXPECT_GT(resident() - before, 170e6);
  large.clear();
  EXPECT_LT(resident() - before, 20e6);
}

}  // namespace
}  // namespace quicksand

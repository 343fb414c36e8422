// The same bits whatever the number of threads.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "engine/threads/parallel.hpp"
#include "tests/engine/step/motion.hpp"

namespace quicksand {
namespace {

using namespace test;

template <class T>
bool same_bits(const T& a, const T& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

template <int D>
State<D> advanced(const Scene& scene, int threads, int steps, double dt) {
  State<D> s;
  with_threads(threads, [&] {
    s = make_state<D>(scene);
    advance_times(s, steps, dt);
  });
  return s;
}

template <int D>
void expect_same(const State<D>& a, const State<D>& b) {
  EXPECT_TRUE(same_bits(a.soil.x, b.soil.x));
  EXPECT_TRUE(same_bits(a.soil.v, b.soil.v));
  EXPECT_TRUE(same_bits(a.soil.stress, b.soil.stress));
  EXPECT_TRUE(same_bits(a.soil.porosity, b.soil.porosity));
  EXPECT_TRUE(same_bits(a.soil.plastic_strain, b.soil.plastic_strain));
  EXPECT_TRUE(same_bits(a.water.x, b.water.x));
  EXPECT_TRUE(same_bits(a.water.v, b.water.v));
  EXPECT_TRUE(same_bits(a.pressure, b.pressure));
  EXPECT_EQ(a.time, b.time);
}

TEST(Determinism, AnyNumberOfThreadsGivesTheSameBits) {
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 8);
  const Scene scene = collapse(0.025);
  const State<2> one = advanced<2>(scene, 1, 100, 2e-4);
  double moved = 0;
  for (std::size_t p = 0; p < one.water.size(); ++p) moved = std::max(moved, std::abs(one.water.v[p][0]));
  ASSERT_GT(moved, 0.01);  // something happened
  for (const int threads : {2, 3, 8}) expect_same(one, advanced<2>(scene, threads, 100, 2e-4));
}

TEST(Determinism, AnyNumberOfThreadsGivesTheSameBitsInSpace) {
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 8);
  Scene s = space({0.6, 0.5, 0.4}, 0.05);
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0, 0}, {0.2, 0.2, 0.4});
  add_body(s, "pool", BodyKind::water, {0.2, 0, 0}, {0.3, 0.3, 0.4});
  const State<3> one = advanced<3>(s, 1, 30, 2e-4);
  for (const int threads : {2, 3, 8}) expect_same(one, advanced<3>(s, threads, 30, 2e-4));
}

/// Enough blocks that several of them make a tile.
TEST(Determinism, LargeTilesGiveTheSameBits) {
  const tbb::global_control more(tbb::global_control::max_allowed_parallelism, 8);
  const Scene fine = collapse(0.01);
  const State<2> one = advanced<2>(fine, 1, 12, 1e-4);
  EXPECT_EQ(one.blocks.tiles().edge(), (Cell<2>{4, 1}));
  for (const int threads : {2, 3, 8}) expect_same(one, advanced<2>(fine, threads, 12, 1e-4));

  Scene s = space({1.6, 1.2, 1.2}, 0.05);
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0, 0}, {0.5, 1.1, 1.2});
  add_body(s, "pool", BodyKind::water, {0.5, 0, 0}, {1.5, 1, 1.2});
  const State<3> deep = advanced<3>(s, 1, 3, 1e-4);
  EXPECT_EQ(deep.blocks.tiles().edge(), (Cell<3>{2, 1, 1}));
  for (const int threads : {2, 8}) expect_same(deep, advanced<3>(s, threads, 3, 1e-4));
}

}  // namespace
}  // namespace quicksand

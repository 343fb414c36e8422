// Lanes of any processor do what doubles do one by one.
#include "engine/grid/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "engine/grid/shuffles.hpp"
#include "engine/grid/window_rows.hpp"

namespace quicksand {
namespace {

BatchLanes from(double first, double step) {
  return lanes_of<kBatch>([&](int k) { return first + step * k; });
}

TEST(Lanes, ArithmeticIsThatOfEveryLane) {
  const BatchLanes a = from(-3, 1), b = from(2, -0.25), c = 2 * a - b / 4 + 1.5, d = -c;
  BatchLanes e = a;
  e += b, e *= 3, e -= 1;
  for (int k = 0; k < kBatch; ++k) {
    EXPECT_EQ(c[k], 2 * a[k] - b[k] / 4 + 1.5);
    EXPECT_EQ(d[k], -c[k]);
    EXPECT_EQ(e[k], (a[k] + b[k]) * 3 - 1);
  }
}

TEST(Lanes, MasksChooseAndCount) {
  const BatchLanes a = lane_numbers();
  const auto mask = (a > 1) & (a <= 5);
  const BatchLanes chosen = where(mask, a, BatchLanes{});
  for (int k = 0; k < kBatch; ++k) EXPECT_EQ(chosen[k], k > 1 && k <= 5 ? k : 0);
  EXPECT_EQ(bits_of(mask), 0b111100u);
  EXPECT_EQ(bits_of((a < 1) | (a >= 7)), 0b10000001u);
  EXPECT_TRUE(any_of(mask, 3));
  EXPECT_FALSE(any_of(mask, 2));
}

TEST(Lanes, RootsAreRoots) {
  const BatchLanes a = from(0.25, 1.5), root = square_root(a), inverse = inverse_root(a);
  for (int k = 0; k < kBatch; ++k) {
    EXPECT_EQ(root[k], std::sqrt(a[k]));
    EXPECT_NEAR(inverse[k] * std::sqrt(a[k]), 1, 1e-15);
  }
}

TEST(Lanes, OnlyAskedForNumbersAreRead) {
  for (int count = 0; count <= kBatch; ++count) {
    const std::vector<double> numbers(count, 7);  // what lies behind is not ours
    const BatchLanes some = some_lanes_from(numbers.data(), count);
    for (int k = 0; k < kBatch; ++k) EXPECT_EQ(some[k], k < count ? 7 : 0);
  }
}

template <int n>
void expect_columns() {
  for (int count = 0; count <= kBatch; ++count) {
    std::vector<double> numbers(n * count);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = 1.0 + static_cast<double>(i);
    const auto column = columns<n>(numbers.data(), count);
    for (int k = 0; k < kBatch; ++k)
      for (int i = 0; i < n; ++i) EXPECT_EQ(column[i][k], k < count ? 1 + n * k + i : 0) << n << ' ' << count;
  }
}
template <int n>
void expect_columns_back() {
  std::array<double, n * kBatch> numbers, again{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = 1.0 + static_cast<double>(i);
  put_columns<n>(columns<n>(numbers.data(), kBatch), again.data());
  EXPECT_EQ(again, numbers);
}
TEST(Lanes, ColumnsOfVectors) {
  expect_columns<2>(), expect_columns<3>(), expect_columns<4>(), expect_columns<6>();
  expect_columns_back<2>(), expect_columns_back<4>();
}

template <int N>
void expect_shuffles() {
  std::array<Lanes<N>, N> rows;
  for (int i = 0; i < N; ++i) rows[i] = lanes_of<N>([&](int k) { return 100.0 * i + k; });
  const auto columns = transposed<N>(rows);
  for (int i = 0; i < N; ++i)
    for (int k = 0; k < N; ++k) EXPECT_EQ(columns[k][i], rows[i][k]);
  const auto pairs = interleaved<N>(rows[0], rows[1]);
  for (int k = 0; k < N; ++k)
    for (int i = 0; i < 2; ++i) EXPECT_EQ(pairs[(2 * k + i) / N][(2 * k + i) % N], rows[i][k]);
  const auto apart = parted<N>(pairs[0], pairs[1]);
  for (int k = 0; k < N; ++k)
    for (int i = 0; i < 2; ++i) EXPECT_EQ(apart[i][k], rows[i][k]);
}
TEST(Lanes, ShufflesMoveEveryLane) {
  expect_shuffles<2>(), expect_shuffles<4>(), expect_shuffles<8>();
  const BatchLanes a = lane_numbers(), again = joined<4>(low_half<8>(a), high_half<8>(a));
  const double pair[] = {3, 4};
  const Lanes<8> four = four_times(pair);
  for (int k = 0; k < kBatch; ++k) {
    EXPECT_EQ(again[k], k);
    EXPECT_EQ(four[k], pair[k % 2]);
  }
}

template <int d, int D>
void expect_places() {
  using Rows = WindowRows<d, D>;
  std::vector<int> places;
  for (int k = 0; k < Walls<D>::kFaces; ++k) places.push_back(Rows::place(k));
  std::sort(places.begin(), places.end());
  EXPECT_EQ(std::unique(places.begin(), places.end()), places.end());
  EXPECT_GE(places.front(), 0);
  EXPECT_LT(places.back(), 4 * Rows::count);
}
TEST(WindowRows, NumbersOfNodesPointByPoint) {
  const std::array<BatchLanes, 3> a{from(1, 1), from(11, 1), from(21, 1)},
      b{from(-1, 1), from(-11, 1), from(-21, 1)};
  const NodesByPoint<1> single = by_point(a);
  const NodesByPoint<2> pairs = by_point(a, b);
  for (int k = 0; k < kBatch; ++k)
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(single[k][i], i < 3 ? a[i][k] : 0);
      EXPECT_EQ(pairs[k][2 * i], i < 3 ? a[i][k] : 0);
      EXPECT_EQ(pairs[k][2 * i + 1], i < 3 ? b[i][k] : 0);
    }
}
TEST(WindowRows, EveryNodeHasAPlaceOfItsOwn) {
  expect_places<0, 2>(), expect_places<1, 2>();
  expect_places<0, 3>(), expect_places<1, 3>(), expect_places<2, 3>();
}

}  // namespace
}  // namespace quicksand

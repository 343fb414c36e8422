#include "server/places.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace quicksand {
namespace {

TEST(PlacesTest, GivesSoManyAndTakesThemBack) {
  Places places(2);
  auto one = places.take(), two = places.take();
  ASSERT_TRUE(one && two);
  EXPECT_FALSE(places.take());
  EXPECT_EQ(places.taken(), 2);
  const auto copy = two;
  two.reset();
  EXPECT_FALSE(places.take());  // a copy still holds it
  one.reset();
  EXPECT_TRUE(places.take());
  EXPECT_EQ(places.taken(), 1);
}

TEST(PlacesTest, NoneMeansNone) { EXPECT_FALSE(Places(0).take()); }

}  // namespace
}  // namespace quicksand

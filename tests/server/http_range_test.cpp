#include "server/http_range.hpp"

#include <gtest/gtest.h>

namespace quicksand {
namespace {

using Kind = RangeAnswer::Kind;

void expect_part(const char* header, std::uint64_t size, std::uint64_t first, std::uint64_t last) {
  const RangeAnswer range = parse_range(header, size);
  EXPECT_EQ(range.kind, Kind::part) << header;
  EXPECT_EQ(range.first, first) << header;
  EXPECT_EQ(range.last, last) << header;
}

TEST(ParseRange, Parts) {
  expect_part("bytes=0-0", 100, 0, 0);
  expect_part("bytes=10-19", 100, 10, 19);
  expect_part("bytes=10-", 100, 10, 99);
  expect_part("bytes=10-1000", 100, 10, 99);
  expect_part("bytes=-10", 100, 90, 99);
  expect_part("bytes=-1000", 100, 0, 99);
  expect_part(" bytes=99-99999999999999999999999999 ", 100, 99, 99);
}

TEST(ParseRange, PastTheEnd) {
  for (const char* header : {"bytes=100-", "bytes=100-200", "bytes=99999999999999999999999999-", "bytes=-0"})
    EXPECT_EQ(parse_range(header, 100).kind, Kind::unsatisfiable) << header;
  EXPECT_EQ(parse_range("bytes=0-", 0).kind, Kind::unsatisfiable);
  EXPECT_EQ(parse_range("bytes=-5", 0).kind, Kind::unsatisfiable);
}

TEST(ParseRange, WhatIsNoSingleRangeIsIgnored) {
  for (const char* header : {"", "bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=a-b", "lines=0-5",
                             "bytes=0-1,5-6", "bytes=-1-5", "bytes=0x1-2", "bytes=+1-2"})
    EXPECT_EQ(parse_range(header, 100).kind, Kind::whole) << header;
}

TEST(EtagMatches, WeakComparison) {
  EXPECT_TRUE(etag_matches("\"a\"", "\"a\"", EtagComparison::weak));
  EXPECT_TRUE(etag_matches("W/\"a\"", "\"a\"", EtagComparison::weak));
  EXPECT_TRUE(etag_matches("\"b\", W/\"a\"", "W/\"a\"", EtagComparison::weak));
  EXPECT_TRUE(etag_matches("*", "\"a\"", EtagComparison::weak));
  EXPECT_FALSE(etag_matches("", "\"a\"", EtagComparison::weak));
  EXPECT_FALSE(etag_matches("a", "\"a\"", EtagComparison::weak));
}

TEST(EtagMatches, StrongComparison) {
  EXPECT_TRUE(etag_matches("\"a\"", "\"a\"", EtagComparison::strong));
  EXPECT_FALSE(etag_matches("W/\"a\"", "\"a\"", EtagComparison::strong));
  EXPECT_FALSE(etag_matches("W/\"a\"", "W/\"a\"", EtagComparison::strong));
  EXPECT_FALSE(etag_matches("Wed, 21 Oct 2015 07:28:00 GMT", "\"a\"", EtagComparison::strong));
}

}  // namespace
}  // namespace quicksand

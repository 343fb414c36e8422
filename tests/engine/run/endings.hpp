#pragma once
// What tests ask of runs that end before their time, or take steps back.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/verification/recorder.hpp"

namespace quicksand::test {

inline bool says(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

/// Every number that was written is one, and times ascend.
inline void expect_clean(const Recorder& results) {
  for (const Frame& f : results.frames) {
    for (double x : f.position) ASSERT_TRUE(std::isfinite(x)) << f.time;
    for (const FrameField& field : f.fields)
      for (float v : field.values) ASSERT_TRUE(std::isfinite(v)) << field.name << ' ' << f.time;
  }
  for (std::size_t i = 1; i < results.times.size(); ++i) ASSERT_GT(results.times[i], results.times[i - 1]);
}

}  // namespace quicksand::test

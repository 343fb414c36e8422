#pragma once
// Malformed and impossible cases: a sound case, changed by a JSON patch, must give exactly these pointers.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/api/heave_case.hpp"

namespace quicksand::test {

struct Mutation {
  const char* name;
  const char* patch;  ///< RFC 6902
  std::vector<std::string> expected;
};

#define ADD(path, value) R"([{"op":"add","path":")" path R"(","value":)" value "}]"
#define SET(path, value) R"([{"op":"replace","path":")" path R"(","value":)" value "}]"
#define REMOVE(path) R"([{"op":"remove","path":")" path R"("}])"

inline std::string patched(const char* patch) {
  return nlohmann::json::parse(heave_case()).patch(nlohmann::json::parse(patch)).dump();
}

inline void expect_faults(const Mutation& mutation) {
  const ParsedCase parsed = parse_case(patched(mutation.patch));
  EXPECT_FALSE(parsed.scene.has_value());
  auto expected = mutation.expected;
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(pointers(parsed.faults), expected) << said(parsed.faults);
  for (const Fault& fault : parsed.faults) EXPECT_GE(fault.detail.size(), 10u) << fault.pointer;
}

class CaseFaults : public testing::TestWithParam<Mutation> {};

inline std::string name_of(const testing::TestParamInfo<Mutation>& info) { return info.param.name; }

}  // namespace quicksand::test

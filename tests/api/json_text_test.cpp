#include "api/json_text.hpp"

#include <gtest/gtest.h>

#include "tests/api/heave_case.hpp"

namespace quicksand {
namespace {

TEST(JsonText, SyntaxFaultHasLineColumnAndPlace) {
  const JsonText json = read_json("{\n  \"domain\": {\n    \"max\": [1, oops]\n  }\n}");
  EXPECT_FALSE(json.complete);
  ASSERT_EQ(json.faults.size(), 1u);
  EXPECT_EQ(json.faults[0].pointer, "/domain/max/0");
  EXPECT_NE(json.faults[0].detail.find("line 3, column 16"), std::string::npos) << json.faults[0].detail;
}

TEST(JsonText, AMissingCommaIsSaid) {
  const auto said = [](const char* text) { return read_json(text).faults.at(0).detail; };
  EXPECT_NE(said("{\"a\": 1 \"b\": 2}").find("expected ',' or '}'"), std::string::npos)
      << said("{\"a\": 1 \"b\": 2}");
  EXPECT_NE(said("[1 2]").find("expected ',' or ']'"), std::string::npos) << said("[1 2]");
}

TEST(JsonText, RefusesWhatIsNotOneJsonText) {
  for (const char* text : {"", " ", "{", "[1,]", "{\"a\":1} x", "nul", "{'a':1}", "{\"a\" 1}", "[1 2]",
                           "// c\n{}", "1e400", "NaN", "\"\xff\"", "[\"\\u0000\"]", "{\"\\u0000\":1}"}) {
    const JsonText json = read_json(text);
    EXPECT_FALSE(json.complete) << text;
    EXPECT_EQ(json.faults.size(), 1u) << text;
  }
}

TEST(JsonText, DuplicateKeysAreFaultsAndTheFirstIsKept) {
  const JsonText json = read_json(R"({"a": {"b": [0, {"c/d": 1, "c/d": {"c/d": 2}}]}, "a": 3})");
  EXPECT_TRUE(json.complete);
  EXPECT_EQ(test::pointers(json.faults), (std::vector<std::string>{"/a", "/a/b/1/c~1d"}));
  EXPECT_EQ(json.value.dump(), R"({"a":{"b":[0,{"c/d":1}]}})");
}

TEST(JsonText, DepthIsCapped) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_TRUE(read_json(nested(max_depth)).complete);
  EXPECT_FALSE(read_json(nested(max_depth + 1)).complete);
  for (const std::string& bomb : {std::string(100'000, '['), nested(100'000)}) {
    const ParsedCase parsed = parse_case(bomb);
    ASSERT_EQ(parsed.faults.size(), 1u);
    EXPECT_NE(parsed.faults[0].detail.find("nested deeper than 64"), std::string::npos)
        << parsed.faults[0].detail;
  }
  std::string objects;
  for (int k = 0; k < 100'000; ++k) objects += "{\"union\":";
  EXPECT_EQ(parse_case(objects).faults.size(), 1u);
}

TEST(JsonText, WholeNumbersCountAsIntegersHoweverWritten) {
  const JsonText json = read_json("[1e5, 3.0, 3.7, -0.0, 1e300]");
  ASSERT_TRUE(json.complete);
  EXPECT_TRUE(json.value[0].is_number_integer());
  EXPECT_TRUE(json.value[1].is_number_integer());
  EXPECT_TRUE(json.value[2].is_number_float());
  EXPECT_TRUE(json.value[4].is_number_float());
  EXPECT_EQ(json.value[0].get<double>(), 1e5);
}

TEST(JsonText, LongStringsAreRefused) {
  const auto quoted = [](std::size_t length) { return nlohmann::json(std::string(length, 'a')).dump(); };
  EXPECT_TRUE(read_json(quoted(max_string)).complete);
  EXPECT_FALSE(read_json(quoted(max_string + 1)).complete);
}

TEST(JsonText, DocumentsThatAreNotObjectsAreOneFault) {
  for (const char* text : {"3", "null", "[]", "\"case\"", "true"}) {
    const ParsedCase parsed = parse_case(text);
    ASSERT_EQ(parsed.faults.size(), 1u) << text << test::said(parsed.faults);
    EXPECT_EQ(parsed.faults[0].pointer, "");
  }
}

}  // namespace
}  // namespace quicksand

// The examples of api/case.md are sound cases: the first is whole, each other one a merge patch of it.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/api/heave_case.hpp"

namespace quicksand {
namespace {

using nlohmann::json;

struct Example {
  std::string title;
  json content;
};

/// The page's blocks of JSON, each with the heading above it.
std::vector<Example> examples() {
  std::ifstream page(CASE_PAGE);
  std::vector<Example> all;
  std::string title, text;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("### ", 0) == 0) title = line.substr(4);
    if (inside && line == "```") {
      inside = false;
      all.push_back({title, json::parse(text)});
    }
    if (inside) text += line + "\n";
    if (line == "```json") inside = true, text.clear();
  }
  return all;
}

std::vector<Fault> faults_of(const json& document) { return parse_case(document.dump()).faults; }

TEST(CasePage, ExamplesAreSoundCases) {
  const std::vector<Example> all = examples();
  ASSERT_GT(all.size(), 15u);
  EXPECT_TRUE(all.front().content.contains("schema"));
  for (std::size_t k = 0; k < all.size(); ++k) {
    json document = all.front().content;
    if (k > 0) document.merge_patch(all[k].content);
    EXPECT_TRUE(faults_of(document).empty()) << all[k].title << test::said(faults_of(document));
  }
}

}  // namespace
}  // namespace quicksand

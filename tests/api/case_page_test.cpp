// The examples of api/case.md are sound cases: the first is whole, each other one a merge patch of it.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/api/heave_case.hpp"
#include "tests/verification/recorder.hpp"

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

/// The page's first example as changed by the one whose title begins with `title`.
Scene scene_of(const std::string& title) {
  const std::vector<Example> all = examples();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Example& e) { return e.title.rfind(title, 0) == 0; });
  json document = all.front().content;
  document.merge_patch(found->content);
  return parse_case(document.dump()).scene.value();
}

/// Both stages end at rest long before their time, with the bank standing.
TEST(CasePage, GravityLoadingAndExcavationRun) {
  const test::Recorded r = test::record(scene_of("Gravity loading"));
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_LT(r.report.sim_time, 2);
  EXPECT_NEAR(r.report.ledger.soil_removed, 0.6 * 2650 * 0.5 * 0.2, 1e-6);
  EXPECT_LT(r.results.last("body.ground.largest_displacement"), 1e-3);
  EXPECT_LT(r.report.ledger.momentum_residual, 1e-10);
}

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

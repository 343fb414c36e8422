// Every case that is shipped can be run in every preset, and its resolved form says the same.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/api/heave_case.hpp"

namespace quicksand {
namespace {

std::vector<std::filesystem::path> shipped() {
  std::vector<std::filesystem::path> files;
  for (const auto& folder : std::filesystem::directory_iterator(SHIPPED_CASES))
    if (std::filesystem::exists(folder.path() / "case.json")) files.push_back(folder.path() / "case.json");
  std::sort(files.begin(), files.end());
  return files;
}

TEST(ShippedCases, CanBeRunInEveryPreset) {
  ASSERT_GT(shipped().size(), 3u);
  for (const auto& file : shipped()) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    for (const Preset preset : {Preset::draft, Preset::standard, Preset::fine}) {
      const ParsedCase parsed = parse_case(text.str(), preset);
      ASSERT_TRUE(parsed.scene) << file << test::said(parsed.faults);
      const std::string once = resolved_case(*parsed.scene);
      const ParsedCase again = parse_case(once);
      ASSERT_TRUE(again.scene) << file << test::said(again.faults);
      EXPECT_EQ(resolved_case(*again.scene), once) << file;
    }
  }
}

}  // namespace
}  // namespace quicksand

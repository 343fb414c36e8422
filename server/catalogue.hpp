#pragma once
#include <filesystem>
#include <map>
#include <string>

namespace quicksand {

struct ShippedCase {
  std::string description;
  std::string text;  ///< the case file as shipped
};

/// The ready-to-run cases `<folder>/<name>/case.json`, read once at start. What does not parse is left out
/// with a warning. An empty path gives no cases.
std::map<std::string, ShippedCase> read_catalogue(const std::filesystem::path& folder);

/// Where the cases lie when nobody says: `../share/quicksand/cases` or `cases` beside or above the
/// executable. Empty when there are none.
std::filesystem::path find_cases();

}  // namespace quicksand

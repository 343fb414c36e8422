#include "server/catalogue.hpp"

#include <spdlog/spdlog.h>

#include "api/case_json.hpp"
#include "server/files.hpp"

namespace quicksand {

std::map<std::string, ShippedCase> read_catalogue(const std::filesystem::path& folder) {
  std::map<std::string, ShippedCase> cases;
  if (folder.empty()) return cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto text = read_text(entry.path() / "case.json");
    if (!text) continue;
    const ParsedCase parsed = parse_case(*text);
    const std::string name = entry.path().filename().string();
    if (!parsed.scene) {
      const Fault fault = parsed.faults.empty() ? Fault{} : parsed.faults.front();
      spdlog::warn("case {} left out: {} {}", name, fault.pointer, fault.detail);
      continue;
    }
    cases[name] = {parsed.scene->description, *text};
  }
  return cases;
}

std::filesystem::path find_cases() {
  std::error_code unknown;
  const auto executable = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) return {};
  const auto installed = executable.parent_path().parent_path() / "share/quicksand/cases";
  if (std::filesystem::is_directory(installed)) return installed;
  // A build folder inside the source tree: build/<preset>/bin/quicksand.
  for (auto place = executable.parent_path(); place != place.root_path(); place = place.parent_path())
    if (std::filesystem::is_directory(place / "cases")) return place / "cases";
  return {};
}

}  // namespace quicksand

#include "engine/scene/check.hpp"

#include <algorithm>

#include "engine/scene/check_parts.hpp"

namespace quicksand {

std::string escaped(const std::string& name) {
  std::string step;
  for (const char c : name) step += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return step;
}

std::string at_soil(const std::string& name, const std::string& rest) {
  return "/materials/soils/" + escaped(name) + rest;
}

std::string there_is_no(const std::string& what, const std::string& name,
                        const std::vector<std::string>& names) {
  constexpr std::size_t most = 8;  // a longer list helps nobody
  std::string words = "there is no " + what + " \"" + name + "\": ";
  if (names.empty()) return words + "the case has none";
  words += names.size() == 1 ? "there is" : "there are";
  for (std::size_t k = 0; k < std::min(names.size(), most); ++k)
    words += std::string(k == 0 ? "" : k + 1 == names.size() ? " and" : ",") + " \"" + names[k] + "\"";
  return names.size() > most ? words + " and " + std::to_string(names.size() - most) + " more" : words;
}

std::vector<Fault> check(const Scene& scene) {
  Faults faults;
  check_names(scene, faults);
  check_materials(scene, faults);
  check_stages(scene, faults);
  check_output(scene, faults);
  if (check_grid(scene, faults)) {
    check_lines(scene, faults);
    check_bodies(scene, faults);
    check_softness(scene, faults);
  }
  return faults;
}

}  // namespace quicksand

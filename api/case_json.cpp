#include "api/case_json.hpp"

#include <algorithm>

#include "api/consequences.hpp"
#include "api/idle_keys.hpp"
#include "api/json_text.hpp"
#include "api/scene_from_json.hpp"
#include "api/scene_to_json.hpp"
#include "api/schema_check.hpp"
#include "engine/plan/companions.hpp"
#include "engine/scene/check.hpp"

namespace quicksand {
namespace {

void append(std::vector<Fault>& to, std::vector<Fault> more) {
  to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// One fault per place, the first said; then at most `max_faults`, with a word about the rest.
std::vector<Fault> presentable(std::vector<Fault> faults) {
  std::vector<Fault> kept;
  std::set<std::string> said;
  for (Fault& fault : faults)
    if (said.insert(fault.pointer).second) kept.push_back(std::move(fault));
  if (kept.size() > max_faults) {
    const std::size_t rest = kept.size() - max_faults;
    kept.resize(max_faults);
    kept.push_back({"", "and at least " + std::to_string(rest) + " more faults: mend these first"});
  }
  return kept;
}

/// Everything beyond the schema, as far as the document can be read.
Scene read_scene(const nlohmann::json& document, const std::optional<Preset>& preset,
                 std::set<std::string> refused, std::vector<Fault>& faults) {
  Reading reading{refused, faults};
  const Scene scene = scene_from_json(document, preset, reading);

  const std::set<std::string> unreadable = refused;
  std::vector<Fault> choices;
  Reading choosing{refused, choices, reading.dimensions};
  check_choices(document, scene, choosing);
  append(faults, without_consequences(std::move(choices), unreadable));

  std::vector<Fault> impossible = check(scene);
  if (impossible.size() > max_faults) impossible.resize(max_faults + 1);  // one more: to say so
  append(faults, without_consequences(std::move(impossible), refused));
  return scene;
}

}  // namespace

ParsedCase parse_case(const std::string& text, const std::optional<Preset>& preset) {
  ParsedCase parsed;
  JsonText json = read_json(text);
  parsed.faults = std::move(json.faults);
  if (!json.complete) return parsed;

  Explanation schema = check_schema(json.value);
  append(parsed.faults, std::move(schema.faults));
  if (json.value.is_object() && parsed.faults.size() <= max_faults) {
    Scene scene = read_scene(json.value, preset, std::move(schema.refused), parsed.faults);
    if (parsed.faults.empty())
      if (auto fault = no_companion(scene)) parsed.faults.push_back(std::move(*fault));
    if (parsed.faults.empty()) parsed.scene = std::move(scene);
  }
  parsed.faults = presentable(std::move(parsed.faults));
  return parsed;
}

std::string resolved_case(const Scene& scene) { return scene_to_json(scene).dump(2) + "\n"; }

}  // namespace quicksand

#include "api/case_json.hpp"

#include <algorithm>

#include "api/consequences.hpp"
#include "api/idle_keys.hpp"
#include "api/json_text.hpp"
#include "api/scene_from_json.hpp"
#include "api/scene_to_json.hpp"
#include "api/schema_check.hpp"
#include "engine/plan/companions.hpp"
#include "engine/plan/settings_choice.hpp"
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

/// The document without fault, its cells chosen where it leaves them to target_error or budget_seconds.
void choose(const nlohmann::json& document, const Calibration& machine, ParsedCase& parsed) {
  const auto with_preset = [&](Preset preset) {
    std::set<std::string> refused;
    std::vector<Fault> faults;
    Reading reading{refused, faults};
    return scene_from_json(document, preset, reading);
  };
  SettingsChoice choice = choose_settings(with_preset, machine);
  if (choice.fault) parsed.faults.push_back(std::move(*choice.fault));
  parsed.scene = std::move(choice.scene);
}

}  // namespace

ParsedCase parse_case(const std::string& text, const std::optional<Preset>& preset,
                      const Calibration& machine) {
  ParsedCase parsed;
  JsonText json = read_json(text);
  parsed.faults = std::move(json.faults);
  if (!json.complete) return parsed;

  Explanation schema = check_schema(json.value);
  append(parsed.faults, std::move(schema.faults));
  if (json.value.is_object() && parsed.faults.size() <= max_faults) {
    Scene scene = read_scene(json.value, preset, std::move(schema.refused), parsed.faults);
    Numerics& numerics = scene.numerics;
    if (preset && numerics.chosen.empty()) numerics.target_error.reset(), numerics.budget_seconds.reset();
    const bool open = (numerics.target_error || numerics.budget_seconds) && numerics.chosen.empty();
    if (parsed.faults.empty()) parsed.scene = std::move(scene);
    if (parsed.scene && open) choose(json.value, machine, parsed);
    if (parsed.scene)
      if (auto fault = no_companion(*parsed.scene)) {
        parsed.faults.push_back(std::move(*fault));
        parsed.scene.reset();
      }
  }
  parsed.faults = presentable(std::move(parsed.faults));
  return parsed;
}

std::string resolved_case(const Scene& scene) { return scene_to_json(scene).dump(2) + "\n"; }

}  // namespace quicksand

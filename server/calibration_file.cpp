#include "server/calibration_file.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "server/files.hpp"

namespace quicksand {
namespace {
constexpr std::array<const char*, kSceneKinds> kind_names{"soil",       "water",       "both",
                                                          "soil space", "water space", "both space"};
}  // namespace

std::filesystem::path user_calibration() {
  const auto under = [](const char* variable, const char* folder) -> std::filesystem::path {
    const char* base = std::getenv(variable);
    return base && *base ? std::filesystem::path(base) / folder : std::filesystem::path();
  };
  std::filesystem::path cache = under("XDG_CACHE_HOME", "quicksand");
  if (cache.empty()) cache = under("HOME", ".cache/quicksand");
  return cache / "calibration.json";
}

std::filesystem::path state_calibration(const std::filesystem::path& state) {
  return state / "calibration.json";
}

std::string calibration_json(const Calibration& calibration) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < kSceneKinds; ++k)
    json[kind_names[k]] = {{"step_seconds", calibration.cost[k].step},
                           {"point_seconds", calibration.cost[k].point}};
  const OutputCost& output = calibration.output;
  json["output"] = {{"start_seconds", output.start}, {"seed_point_seconds", output.seed_point},
                    {"frame_seconds", output.frame}, {"frame_point_seconds", output.frame_point},
                    {"field_seconds", output.field}, {"component_seconds", output.component},
                    {"flush_seconds", output.flush}};
  return json.dump(2) + "\n";
}

Calibration read_calibration(const std::filesystem::path& file) {
  Calibration calibration;
  const auto text = read_text(file);
  if (!text) return calibration;
  try {
    const auto json = nlohmann::json::parse(*text);
    for (std::size_t k = 0; k < kSceneKinds; ++k)
      calibration.cost[k] = {json.at(kind_names[k]).at("step_seconds"),
                             json.at(kind_names[k]).at("point_seconds")};
    // Of older versions, which told it otherwise or not at all, only the steps are taken.
    if (const auto output = json.find("output");
        output != json.end() && output->contains("component_seconds"))
      calibration.output = {output->at("start_seconds"), output->at("seed_point_seconds"),
                            output->at("frame_seconds"), output->at("frame_point_seconds"),
                            output->at("field_seconds"), output->at("component_seconds"),
                            output->at("flush_seconds")};
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return calibration;
}

}  // namespace quicksand

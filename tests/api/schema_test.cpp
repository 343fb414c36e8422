// The schema as a document: draft-07 in structure, and every key described with unit and range.

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "api/case_json.hpp"
#include "api/openapi.hpp"
#include "api/words.hpp"
#include "tests/api/schema_text.hpp"

namespace quicksand {
namespace {

using nlohmann::json;
using test::resolved, test::schema;

/// Calls f(node, where) for every schema node of the document.
void walk(const json& node, const std::string& where,
          const std::function<void(const json&, const std::string&)>& f) {
  if (!node.is_object()) return;  // additionalProperties: false
  f(node, where);
  for (const char* key : {"properties", "definitions"})
    if (node.contains(key))
      for (const auto& item : node[key].items()) walk(item.value(), where + "/" + key + "/" + item.key(), f);
  for (const char* key : {"items", "additionalProperties", "propertyNames"})
    if (node.contains(key)) walk(node[key], where + "/" + key, f);
  if (node.contains("anyOf"))
    for (const json& option : node["anyOf"]) walk(option, where + "/anyOf", f);
}

bool number_like(const json& node) {
  if (!node.contains("type")) return false;
  const json types = node["type"].is_array() ? node["type"] : json::array({node["type"]});
  return std::any_of(types.begin(), types.end(),
                     [](const json& t) { return t == "number" || t == "integer"; });
}

/// Whether a keyword of draft-07 (of those in use, and x-unit) has a value of the right form.
bool well_formed(const std::string& key, const json& value) {
  static const std::set<std::string> texts{"$schema", "$ref", "title", "description", "pattern", "x-unit"};
  static const std::set<std::string> numbers{"minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"};
  static const std::set<std::string> counts{"minLength", "maxLength",     "minItems",
                                            "maxItems",  "minProperties", "maxProperties"};
  static const std::set<std::string> nodes{"properties", "definitions", "items", "propertyNames"};
  static const std::set<std::string> types{"null",   "boolean", "object", "array",
                                           "number", "string",  "integer"};
  if (texts.contains(key)) return value.is_string();
  if (numbers.contains(key)) return value.is_number();
  if (counts.contains(key)) return value.is_number_unsigned();
  if (nodes.contains(key)) return value.is_object();
  if (key == "additionalProperties") return value.is_object() || value.is_boolean();
  if (key == "required") return std::set<json>(value.begin(), value.end()).size() == value.size();
  if (key == "enum" || key == "anyOf") return value.is_array() && !value.empty();
  if (key == "type") {
    const json all = value.is_array() ? value : json::array({value});
    return std::all_of(all.begin(), all.end(),
                       [](const json& t) { return types.contains(t.get<std::string>()); });
  }
  return key == "const" || key == "default";
}

TEST(Schema, IsDraft07InStructure) {
  EXPECT_EQ(schema()["$schema"], "http://json-schema.org/draft-07/schema#");
  walk(schema(), "", [&](const json& node, const std::string& where) {
    for (const auto& item : node.items())
      EXPECT_TRUE(well_formed(item.key(), item.value())) << where << " " << item.key();
    if (node.contains("$ref")) {
      EXPECT_NO_THROW(resolved(node)) << where;
    }
    if (!node.contains("required")) return;
    for (const json& key : node["required"])
      EXPECT_TRUE(node["properties"].contains(key.get<std::string>())) << where << key;
  });
}

TEST(Schema, DescribesEveryKeyWithUnitAndRange) {
  std::size_t keys = 0;
  walk(schema(), "", [&](const json& node, const std::string& where) {
    if (!node.contains("properties")) return;
    EXPECT_EQ(node["additionalProperties"], false) << where;
    for (const auto& item : node["properties"].items()) {
      const json& key = item.value();
      const std::string place = where + "/" + item.key();
      ++keys;
      EXPECT_GE(key.value("description", "").size(), 8u) << place;
      const json& meant = resolved(key);
      const bool vector = meant.contains("items") && number_like(resolved(meant["items"]));
      EXPECT_EQ(number_like(meant) || vector,
                key.contains("x-unit") && !meant.contains("anyOf") && item.key() != "polygon")
          << place;
    }
  });
  EXPECT_GT(keys, 120u);
  walk(schema(), "", [](const json& node, const std::string& where) {
    const json type = node.value("type", json());
    if (number_like(node)) {
      EXPECT_TRUE(node.contains("minimum") || node.contains("exclusiveMinimum")) << where;
      EXPECT_TRUE(node.contains("maximum") || node.contains("exclusiveMaximum")) << where;
    }
    EXPECT_TRUE(type != "array" || node.contains("maxItems")) << where;
    EXPECT_TRUE(type != "string" || node.contains("maxLength") || node.contains("pattern")) << where;
  });
}

/// Whether the text says when the key is needed or what holds without it.
bool tells_of_absence(const std::string& text) {
  for (const char* word : {"required", "Required", "if absent", "instead of"})
    if (text.find(word) != std::string::npos) return true;
  return false;
}

TEST(Schema, SaysWhatHoldsWithoutAKey) {
  walk(schema(), "", [](const json& node, const std::string& where) {
    if (!node.contains("properties") || node.contains("minProperties")) return;  // one of several shapes
    const json required = node.value("required", json::array());
    for (const auto& item : node["properties"].items()) {
      const bool needed = std::find(required.begin(), required.end(), item.key()) != required.end();
      EXPECT_TRUE(needed || item.value().contains("default") ||
                  tells_of_absence(item.value()["description"].get<std::string>()))
          << where << "/" << item.key();
    }
  });
}

TEST(Schema, DefaultsAreAllowedValuesAndThoseOfTheScene) {
  const json& d = schema()["definitions"];
  const auto default_of = [&](const char* object, const char* key) {
    return d[object]["properties"][key]["default"];
  };
  EXPECT_EQ(default_of("soil", "grain_density"), Soil{}.grain_density);
  EXPECT_EQ(default_of("soil", "porosity"), Soil{}.porosity);
  EXPECT_EQ(default_of("permeability", "law"), word_of(Permeability{}.law));
  EXPECT_EQ(default_of("permeability", "exponent"), Permeability{}.exponent);
  EXPECT_EQ(default_of("soil_model", "over_consolidation_ratio"), SoilModel{}.over_consolidation_ratio);
  EXPECT_EQ(default_of("load", "side"), word_of(Load{}.side));
  EXPECT_EQ(default_of("stage", "heads_ramp"), Stage{}.heads_ramp);
  EXPECT_EQ(default_of("numerics", "quasi_static_transits"), Numerics{}.quasi_static_transits);
  EXPECT_EQ(default_of("water", "density"), Water{}.density);
  EXPECT_EQ(default_of("water", "bulk_modulus"), *Water{}.bulk_modulus);
  EXPECT_EQ(default_of("water", "viscosity"), Water{}.viscosity);
  EXPECT_EQ(default_of("initial", "pressure"), word_of(Initial{}.pressure));
  EXPECT_EQ(default_of("initial", "stress"), word_of(Initial{}.stress));
  EXPECT_EQ(default_of("output", "frame_interval"), Output{}.frame_interval);
  EXPECT_EQ(default_of("output", "series_interval"), Output{}.series_interval);
  EXPECT_EQ(default_of("heave_watch", "threshold"), HeaveWatch{}.threshold);
  EXPECT_EQ(default_of("numerics", "preset"), word_of(Numerics{}.preset));
  EXPECT_EQ(default_of("numerics", "points_per_cell"), Numerics{}.points_per_cell);
  EXPECT_EQ(default_of("numerics", "pic_rate"), Numerics{}.pic_rate);
  EXPECT_EQ(default_of("numerics", "time_step_factor"), Numerics{}.time_step_factor);
  EXPECT_EQ(default_of("numerics", "drift_time"), Numerics{}.drift_time);
  EXPECT_EQ(default_of("numerics", "max_steps"), Numerics{}.max_steps);
}

template <typename Choice>
void expect_words(const json& node) {
  json words = json::array();
  for (const auto& [value, word] : words_of(Choice{})) words.push_back(word);
  EXPECT_EQ(node["enum"], words);
}

TEST(Schema, OffersTheWordsThatAreRead) {
  const json& d = schema()["definitions"];
  expect_words<Dimension>(schema()["properties"]["domain"]["properties"]["dimension"]);
  expect_words<SideKind>(d["side"]["properties"]["kind"]);
  expect_words<PermeabilityLaw>(d["permeability"]["properties"]["law"]);
  expect_words<SoilLaw>(d["soil_model"]["properties"]["law"]);
  expect_words<BodyKind>(d["body"]["properties"]["kind"]);
  expect_words<InitialPressure>(d["initial"]["properties"]["pressure"]);
  expect_words<InitialStress>(d["initial"]["properties"]["stress"]);
  expect_words<Load::Kind>(d["load"]["properties"]["kind"]);
  expect_words<BodySide>(d["load"]["properties"]["side"]);
  expect_words<Preset>(d["numerics"]["properties"]["preset"]);
  expect_words<Kernel>(d["numerics"]["properties"]["kernel"]);
  expect_words<Transfer>(d["numerics"]["properties"]["transfer"]);
  expect_words<PressureScheme>(d["numerics"]["properties"]["pressure"]);
}

TEST(OpenApi, IsCompiledInWhole) {
  const std::string& text = openapi_document();
  EXPECT_EQ(text.rfind("openapi: 3.1", 0), 0u);
  for (const char* path :
       {"/v1/runs:", "/v1/validate:", "/v1/runs/{id}:", "/v1/runs/{id}/case:", "/v1/runs/{id}/results:",
        "/v1/runs/{id}/results/{file}:", "/v1/runs/{id}/cancel:", "/v1/cases:", "/v1/schemas/case:",
        "/v1/openapi.yaml:", "/v1/service-info:", "/healthz:", "/readyz:"})
    EXPECT_NE(text.find(std::string("\n  ") + path + "\n"), std::string::npos) << path;
  EXPECT_EQ(text.back(), '\n');
}

TEST(OpenApi, ItsExampleIsASoundCase) {
  const std::string& text = openapi_document();
  const std::string key = "          example: ";
  const std::size_t at = text.find(key);
  ASSERT_NE(at, std::string::npos);
  const std::size_t begin = at + key.size();
  const ParsedCase parsed = parse_case(text.substr(begin, text.find('\n', begin) - begin));
  EXPECT_TRUE(parsed.scene.has_value());
}

}  // namespace
}  // namespace quicksand

// Every key of the schema is read into the scene and written back: a document that gives it comes out with
// the value that went in, and no key is written that the schema does not know.

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "api/idle_keys.hpp"
#include "api/scene_from_json.hpp"
#include "api/scene_to_json.hpp"
#include "api/schema_check.hpp"
#include "tests/api/heave_case.hpp"
#include "tests/api/schema_text.hpp"

namespace quicksand {
namespace {

using nlohmann::json;
using test::resolved, test::schema;

/// Keys by the place of the schema that describes them ("soil/porosity"), each once however often it occurs.
using Keys = std::set<std::string>;

std::string place_of(const json& node, const std::string& otherwise) {
  return node.contains("$ref") ? node["$ref"].get<std::string>().substr(std::string("#/definitions/").size())
                               : otherwise;
}

/// All keys that the schema knows.
void known_keys(const json& reference, const std::string& otherwise, std::set<const json*>& seen,
                Keys& keys) {
  const json& node = resolved(reference);
  const std::string place = place_of(reference, otherwise);
  if (!seen.insert(&node).second) return;
  if (node.contains("properties"))
    for (const auto& item : node["properties"].items()) {
      keys.insert(place + "/" + item.key());
      known_keys(item.value(), place + "/" + item.key(), seen, keys);
    }
  for (const char* key : {"items", "additionalProperties"})
    if (node.contains(key) && node[key].is_object()) known_keys(node[key], place, seen, keys);
}

/// Keys that the document holds, by the schema's places; a key that the schema does not know is a failure.
void used_keys(const json& document, const json& reference, const std::string& otherwise, Keys& keys) {
  const json& node = resolved(reference);
  const std::string place = place_of(reference, otherwise);
  if (document.is_array() && node.contains("items"))
    for (const json& item : document) used_keys(item, node["items"], place, keys);
  if (!document.is_object()) return;
  for (const auto& item : document.items()) {
    if (!node.contains("properties")) {  // members with free names
      used_keys(item.value(), node["additionalProperties"], place, keys);
      continue;
    }
    ASSERT_TRUE(node["properties"].contains(item.key())) << place << " does not know " << item.key();
    keys.insert(place + "/" + item.key());
    used_keys(item.value(), node["properties"][item.key()], place + "/" + item.key(), keys);
  }
}

/// Everything that `part` says is also said by `whole`.
void expect_within(const json& part, const json& whole, const std::string& pointer) {
  if (part.is_object()) {
    for (const auto& item : part.items()) {
      ASSERT_TRUE(whole.contains(item.key())) << pointer << "/" << item.key() << " is not written";
      expect_within(item.value(), whole[item.key()], pointer + "/" + item.key());
    }
  } else if (part.is_array()) {
    ASSERT_EQ(part.size(), whole.size()) << pointer;
    for (std::size_t k = 0; k < part.size(); ++k)
      expect_within(part[k], whole[k], pointer + "/" + std::to_string(k));
  } else {
    EXPECT_EQ(part, whole) << pointer;
  }
}

/// The scene of a document without fault in its keys, whatever the engine makes of it.
Scene read(const json& document) {
  std::vector<Fault> faults = check_schema(document).faults;
  std::set<std::string> refused;
  Reading reading{refused, faults};
  const Scene scene = scene_from_json(document, {}, reading);
  check_choices(document, scene, reading);
  EXPECT_TRUE(faults.empty()) << test::said(faults);
  return scene;
}

/// Together these give every key. The last two say what cannot be said beside the first: the plane and space,
/// the laws that exclude one another.
std::vector<json> documents() {
  std::vector<json> all;
  all.push_back(json::parse(R"json({
    "schema": "quicksand.case/1", "name": "all", "description": "of the plane",
    "domain": {"dimension": "axisymmetric", "min": [0, -1], "max": [2, 3], "cell_size": 0.25, "sides": {
      "left": {"kind": "symmetry"}, "right": {"kind": "open"}, "bottom": {"kind": "no_slip"}, "top": {"kind": "open"}}},
    "gravity": [0, -9.8],
    "materials": {
      "soils": {
        "clay": {"grain_density": 2700, "porosity": 0.5, "max_porosity": 0.6, "k0": 0.7,
          "permeability": {"law": "power", "value": 1e-9, "exponent": 3},
          "model": {"law": "modified_cam_clay", "poisson_ratio": 0.2, "compression_slope": 0.2,
                    "swelling_slope": 0.04, "critical_state_slope": 1.1, "over_consolidation_ratio": 1.5}},
        "sand": {"permeability": {"law": "ergun", "grain_size": 5e-4},
          "model": {"law": "mohr_coulomb", "young_modulus": 1e7, "poisson_ratio": 0.3, "friction_angle": 30,
                    "dilation_angle": 5, "cohesion": 1000, "tension_cutoff": 100, "residual_cohesion": 10,
                    "softening_strain": 0.05}}},
      "water": {"density": 1001, "bulk_modulus": 2e8, "viscosity": 0.002}},
    "bodies": [
      {"name": "clay", "kind": "saturated_soil", "soil": "clay", "velocity": [0.5, 0],
       "region": {"difference": [{"box": {"min": [0, 0], "max": [2, 1]}}, {"disc": {"center": [1, 1], "radius": 0.25}}]}},
      {"name": "sand", "kind": "saturated_soil", "soil": "sand", "fixed": true,
       "region": {"union": [{"polygon": [[0, 1], [1, 1], [0, 2]]}]}}],
    "walls": [{"name": "block", "block": {"box": {"min": [1, 2], "max": [1.25, 3]}}, "no_slip": true},
              {"name": "pile", "line": {"from": [1, 1], "to": [1, 2]}}],
    "gates": [{"name": "gate", "line": {"from": [0.5, 1], "to": [0.5, 2]}}],
    "reservoirs": [{"name": "lake", "line": {"from": [2, 1], "to": [2, 2]}, "head": 1.5}],
    "initial": {"pressure": "hydrostatic", "water_table": 1.25, "stress": "k0", "k0": 0.6},
    "loads": [
      {"name": "cover", "kind": "traction", "body": "clay", "side": "left", "traction": [0, -100], "ramp": 0.5},
      {"name": "press", "kind": "plate", "body": "clay", "plate": {"from": [0, 1], "to": [0.5, 1]},
       "plate_velocity": [0, -0.125], "rough": true},
      {"name": "weight", "kind": "plate", "body": "clay", "plate": {"from": [1, 1], "to": [1.5, 1]},
       "plate_force": [0, -50]}],
    "stages": [{"name": "one", "duration": 2, "until_rest": {"speed": 0.25, "at_least": 1}, "open_gates": ["gate"],
      "heads": {"lake": 1.75}, "heads_ramp": 0.5, "loads": ["cover"], "remove_bodies": ["sand"], "damping": 0.5,
      "quasi_static": true}],
    "output": {"frame_interval": 0.5, "series_interval": 0.25, "fields": ["velocity"],
      "probes": [{"name": "a", "at": [0.5, 0.5], "quantity": "head"}, {"name": "b", "at": [0.5, 0.75], "quantity": "head"}],
      "sections": [{"name": "cut", "line": {"from": [0, 0], "to": [2, 0]}, "quantity": "flow"}],
      "heave": {"body": "clay", "threshold": 0.001, "below": "a", "above": "b"}},
    "numerics": {"preset": "fine", "cell_size_factor": 0.25, "points_per_cell": 3, "kernel": "linear",
      "transfer": "flip", "pic_rate": 2, "pressure": "implicit", "pressure_tolerance": 1e-9,
      "time_step_factor": 0.5, "drift_time": 0.1, "quasi_static_transits": 100, "max_steps": 1000,
      "error_estimate": "finer",
      "target_error": 0.05, "budget_seconds": 1e6, "chosen": "cells of 0.0625 m"}
  })json"));
  all.push_back(json::parse(R"json({
    "schema": "quicksand.case/1", "name": "space",
    "domain": {"dimension": "space", "min": [0, 0, -1], "max": [2, 3, 1], "cell_size": 0.25, "sides": {
      "left": {"kind": "slip"}, "right": {"kind": "slip"}, "bottom": {"kind": "slip"}, "top": {"kind": "slip"},
      "front": {"kind": "symmetry"}, "back": {"kind": "no_slip"}}},
    "gravity": [0, -9.8, 0.25],
    "materials": {"soils": {"clay": {"permeability": {"law": "constant", "value": 1e-9},
      "model": {"law": "linear_elastic", "young_modulus": 1e6, "poisson_ratio": 0.2}}},
      "water": {"bulk_modulus": "incompressible"}},
    "bodies": [{"name": "clay", "kind": "saturated_soil", "soil": "clay", "velocity": [0, 0, 1], "rotation_rate": 0.5,
      "region": {"difference": [{"box": {"min": [0, 0, -1], "max": [2, 1, 1]}}, {"disc": {"center": [1, 1], "radius": 0.25}}]}}],
    "walls": [{"name": "pile", "line": {"from": [1, 1, -1], "to": [1, 2, 1]}}],
    "reservoirs": [{"name": "lake", "line": {"from": [2, 1, -1], "to": [2, 2, 1]}, "head": 1.5}],
    "initial": {"pressure": "uniform", "uniform_pressure": 12, "stress": "uniform", "uniform_stress": [-1, -2, -3, 0, 1, 2]},
    "loads": [{"name": "weight", "kind": "plate", "body": "clay", "plate": {"from": [0, 1, 0], "to": [1, 1, 1]},
               "plate_force": [0, -50, 0], "ramp": 0.25}],
    "stages": [{"name": "one", "duration": 2}],
    "output": {"probes": [{"name": "a", "at": [0.5, 0.5, 0.5], "quantity": "water_velocity"}]},
    "numerics": {"transfer": "apic", "pressure": "explicit", "time_step": 0.001, "error_estimate": true}
  })json"));
  all.push_back(json::parse(R"json({
    "schema": "quicksand.case/1", "name": "dry", "domain": {"max": [1, 1], "cell_size": 0.25},
    "materials": {"soils": {"sand": {"k0": 0.5, "model":
      {"law": "mohr_coulomb", "young_modulus": 1e7, "poisson_ratio": 0.3, "friction_angle": 30}}}},
    "bodies": [{"name": "sand", "kind": "soil", "soil": "sand", "region": {"box": {"min": [0, 0], "max": [1, 0.5]}}}],
    "stages": [{"name": "one", "duration": 2}]
  })json"));
  return all;
}

TEST(EveryKey, ComesOutAsItWentIn) {
  for (const json& document : documents()) {
    const json written = json::parse(scene_to_json(read(document)).dump());
    expect_within(document, written, "");
    EXPECT_EQ(scene_to_json(read(written)).dump(), scene_to_json(read(document)).dump()) << document["name"];
  }
}

TEST(EveryKey, IsWrittenInSomeScene) {
  Keys known, given, written;
  std::set<const json*> seen;
  known_keys(schema(), "", seen, known);
  for (const json& document : documents()) {
    used_keys(document, schema(), "", given);
    used_keys(json::parse(scene_to_json(read(document)).dump()), schema(), "", written);
  }
  EXPECT_EQ(given, known);
  EXPECT_EQ(written, known);
}

/// Whether the pointer names a place of the document, or a member that one of its objects lacks.
bool leads_somewhere(const json& document, const std::string& pointer) {
  if (pointer.empty()) return true;
  const json::json_pointer place(pointer);
  return document.contains(place) || document.contains(place.parent_pointer());
}

TEST(EveryKey, AnyValueAnywhereIsTakenOrExplained) {
  const json odd[] = {nullptr,
                      true,
                      -1,
                      0,
                      1e-300,
                      1e300,
                      2.5,
                      "x",
                      "",
                      json::array(),
                      json::object(),
                      json{1, 2},
                      json{1, 2, 3},
                      json{{"x", 1}}};
  for (const json& document : documents()) {
    const json places = document.flatten();
    std::set<std::string> done;
    for (const auto& item : places.items()) {
      // The place itself, and everything that holds it.
      for (json::json_pointer place(item.key()); !place.empty(); place.pop_back()) {
        if (!done.insert(place.to_string()).second) break;
        std::vector<json> changed;
        for (const json& value : odd) (changed.emplace_back(document))[place] = value;
        changed.push_back(document.patch(json{{{"op", "remove"}, {"path", place.to_string()}}}));
        for (const json& mutation : changed) {
          const ParsedCase parsed = parse_case(mutation.dump());
          ASSERT_EQ(parsed.scene.has_value(), parsed.faults.empty()) << place;
          for (const Fault& fault : parsed.faults)
            ASSERT_TRUE(leads_somewhere(mutation, fault.pointer)) << place << " gives " << fault.pointer;
          if (!parsed.scene) continue;
          const std::string once = resolved_case(*parsed.scene);
          const ParsedCase again = parse_case(once);
          ASSERT_TRUE(again.scene) << place << test::said(again.faults);
          ASSERT_EQ(resolved_case(*again.scene), once) << place;
        }
      }
    }
  }
}

}  // namespace
}  // namespace quicksand

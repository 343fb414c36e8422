#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// Words for a reader: what is wrong, what is allowed, what to do. Judging is left to the schema validator;
/// this looks at one place that it refused and says why, in the terms of the schema's own texts.
struct Explanation {
  std::vector<Fault> faults;
  std::set<std::string> refused;  ///< pointers that must not be read; with them keys that were probably meant
};

/// Adds what is wrong with `value` itself, not with what it contains. `schema` is the node that governs it,
/// `root` the whole schema (for references). Adds nothing when only contained values are wrong.
void explain(const nlohmann::json& root, const nlohmann::json& schema, const nlohmann::json& value,
             const std::string& pointer, Explanation& out);

/// The schema node for member or item `step` of a value governed by `schema`; null if there is none.
const nlohmann::json* descend(const nlohmann::json& root, const nlohmann::json& schema,
                              const std::string& step);

/// "a number above 0 and below 1 (unit m)" and the like.
std::string allowed(const nlohmann::json& root, const nlohmann::json& schema);

}  // namespace quicksand

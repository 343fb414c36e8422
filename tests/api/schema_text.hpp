#pragma once
// The schema of cases as tests walk it.

#include <nlohmann/json.hpp>
#include <string>

#include "api/case_json.hpp"

namespace quicksand::test {

inline const nlohmann::json& schema() {
  static const auto text = nlohmann::json::parse(case_schema());
  return text;
}

/// What a node refers to, or itself.
inline const nlohmann::json& resolved(const nlohmann::json& node) {
  if (!node.contains("$ref")) return node;
  return schema().at(nlohmann::json::json_pointer(node["$ref"].get<std::string>().substr(1)));
}

}  // namespace quicksand::test

#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// One step of a JSON pointer (RFC 6901), with '~' and '/' escaped.
std::string pointer_step(const std::string& key);

struct JsonText {
  nlohmann::json value;   ///< discarded when `complete` is false
  bool complete = false;  ///< the text is JSON within the limits below; duplicate keys do not change that
  std::vector<Fault>
      faults;  ///< syntax (pointer of the place reached, line and column), limits, duplicate keys
};

/// Deepest nesting of a case; deeper text is refused before it is stored.
constexpr std::size_t max_depth = 64;
/// Longest string or key in bytes.
constexpr std::size_t max_string = 8192;

/// Strict JSON: UTF-8, no duplicate keys (the first value is kept), no NUL characters. Whole numbers written
/// as 3.0 or 1e5 count as integers. Never throws for what the text holds; does not recurse.
JsonText read_json(const std::string& text);

}  // namespace quicksand

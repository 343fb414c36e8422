#include "api/explain.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <regex>

#include "api/json_text.hpp"

namespace quicksand {
namespace {

using nlohmann::json;

/// Follows a local reference ("#/definitions/…"), the only kind in the schema.
const json& resolved(const json& root, const json& schema) {
  const json* node = &schema;
  while (node->contains("$ref"))
    node = &root.at(json::json_pointer((*node)["$ref"].get<std::string>().substr(1)));
  return *node;
}

/// The value as text, shortened; a container only by its kind.
std::string shown(const json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  constexpr std::size_t longest = 60;
  std::string text = value.dump(-1, ' ', true);
  if (text.size() > longest) text = text.substr(0, longest) + "…";
  return text;
}

bool has_type(const json& schema, const std::string& type) {
  if (!schema.contains("type")) return false;
  const json& types = schema["type"];
  return types.is_array() ? std::find(types.begin(), types.end(), type) != types.end() : types == type;
}

bool type_fits(const json& schema, const json& value) {
  if (!schema.contains("type")) return true;
  if (value.is_number())
    return has_type(schema, "number") || (value.is_number_integer() && has_type(schema, "integer"));
  return has_type(schema, value.type_name());  // null, boolean, string, array, object
}

bool range_fits(const json& schema, double value) {
  const auto bound = [&](const char* key) { return schema.contains(key) ? &schema[key] : nullptr; };
  if (const json* b = bound("minimum"); b && value < b->get<double>()) return false;
  if (const json* b = bound("maximum"); b && value > b->get<double>()) return false;
  if (const json* b = bound("exclusiveMinimum"); b && value <= b->get<double>()) return false;
  if (const json* b = bound("exclusiveMaximum"); b && value >= b->get<double>()) return false;
  return true;
}

/// UTF-8 characters, not bytes, as JSON Schema counts.
std::size_t characters(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

bool text_fits(const json& schema, const std::string& text) {
  if (characters(text) < schema.value("minLength", std::size_t{0})) return false;
  if (schema.contains("maxLength") && characters(text) > schema["maxLength"].get<std::size_t>()) return false;
  return !schema.contains("pattern") ||
         std::regex_search(text, std::regex(schema["pattern"].get<std::string>()));
}

bool scalar_fits(const json& root, const json& schema, const json& value) {
  if (schema.contains("anyOf"))
    return std::any_of(schema["anyOf"].begin(), schema["anyOf"].end(),
                       [&](const json& option) { return scalar_fits(root, resolved(root, option), value); });
  if (schema.contains("const")) return value == schema["const"];
  if (schema.contains("enum"))
    return std::find(schema["enum"].begin(), schema["enum"].end(), value) != schema["enum"].end();
  if (!type_fits(schema, value)) return false;
  if (value.is_number()) return range_fits(schema, value.get<double>());
  return !value.is_string() || text_fits(schema, value.get_ref<const std::string&>());
}

/// Edits (insert, delete, replace) that turn one key into the other.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

/// The known key that was probably meant; empty if none is near.
std::string nearest(const std::string& key, const json& properties) {
  constexpr std::size_t longest = 64;  // longer than any key of the format: not a slip of the pen
  if (key.size() > longest) return {};
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, key.size() / 3) + 1;
  for (const auto& item : properties.items())
    if (const std::size_t d = distance(key, item.key()); d < best_distance)
      best_distance = d, best = item.key();
  return best;
}

std::string keys_of(const json& properties) {
  std::string keys;
  for (const auto& item : properties.items()) keys += (keys.empty() ? "" : ", ") + item.key();
  return keys;
}

void refuse(Explanation& out, const std::string& pointer, std::string detail) {
  out.refused.insert(pointer);
  out.faults.push_back({pointer, std::move(detail)});
}

void explain_unknown(const json& properties, const std::string& key, const std::string& pointer,
                     Explanation& out) {
  const std::string meant = nearest(key, properties);
  std::string detail = "unknown key " + shown(key);
  if (!meant.empty()) {
    detail += ": did you mean \"" + meant + "\"?";
    out.refused.insert(pointer + "/" + meant);
  }
  refuse(out, pointer + "/" + pointer_step(key),
         detail + (meant.empty() ? ". " : " ") + "Known here: " + keys_of(properties));
}

/// Names of members that are chosen freely, such as those of soils. The validator reports a wrong one at the
/// object that holds the named ones' container, so this looks into member `key` of what `parent` governs.
void explain_names(const json& root, const json& parent, const std::string& key, const json& member,
                   const std::string& pointer, Explanation& out) {
  const json* reference = descend(root, parent, key);
  if (!reference || !member.is_object()) return;
  const json& schema = resolved(root, *reference);
  if (!schema.contains("propertyNames")) return;
  const json& names = resolved(root, schema["propertyNames"]);
  for (const auto& item : member.items())
    if (!scalar_fits(root, names, item.key()))
      refuse(out, pointer + "/" + pointer_step(item.key()),
             "the name " + shown(item.key()) + " is not allowed: give " + allowed(root, names));
}

void explain_members(const json& root, const json& schema, const json& value, const std::string& pointer,
                     Explanation& out) {
  static const json none = json::object();
  const json& properties = schema.contains("properties") ? schema["properties"] : none;
  const bool closed = schema.contains("additionalProperties") && schema["additionalProperties"] == false;
  std::size_t known = 0;
  for (const auto& item : value.items()) {
    if (properties.contains(item.key()))
      ++known;
    else if (closed)
      explain_unknown(properties, item.key(), pointer, out);
    explain_names(root, schema, item.key(), item.value(), pointer + "/" + pointer_step(item.key()), out);
  }
  if (schema.contains("required"))
    for (const json& key : schema["required"])
      if (!value.contains(key.get_ref<const std::string&>()))
        refuse(out, pointer + "/" + key.get<std::string>(),
               "is missing: give " + allowed(root, properties[key.get<std::string>()]));
  const std::size_t counted = closed ? known : value.size();
  if (counted > schema.value("maxProperties", counted) || (value.empty() && schema.contains("minProperties")))
    refuse(out, pointer,
           closed
               ? "give exactly one of " + keys_of(properties) + ", not " + std::to_string(counted)
               : "holds " + std::to_string(counted) + " entries: at most " + schema["maxProperties"].dump());
}

/// Shortest text of a number; the usual one would write 1e7 as 10000000.0.
std::string number_text(const json& number) {
  if (!number.is_number_float()) return number.dump();
  char buffer[32];
  return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, number.get<double>()).ptr);
}

std::string between(const json& schema, const char* low, const char* high) {
  const bool has_low = schema.contains(low), has_high = schema.contains(high);
  if (has_low && has_high && schema[low] == schema[high]) return schema[low].dump();
  if (has_low && has_high) return schema[low].dump() + " to " + schema[high].dump();
  if (has_high) return "at most " + schema[high].dump();
  return has_low ? "at least " + schema[low].dump() : "";
}

std::string range(const json& schema) {
  std::string text;
  const auto add = [&](const char* key, const char* words) {
    if (schema.contains(key))
      text += (text.empty() ? " " : " and ") + std::string(words) + " " + number_text(schema[key]);
  };
  add("exclusiveMinimum", "above");
  add("minimum", "at least");
  add("exclusiveMaximum", "below");
  add("maximum", "at most");
  return text;
}

}  // namespace

std::string allowed(const json& root, const json& reference) {
  const json& schema = resolved(root, reference);
  const auto join = [](std::string all, const std::string& next) {
    return all.empty() ? next : all + " or " + next;
  };
  std::string text;
  if (schema.contains("anyOf")) {
    for (const json& option : schema["anyOf"]) text = join(text, allowed(root, option));
  } else if (schema.contains("enum")) {
    for (const json& option : schema["enum"]) text += (text.empty() ? "one of " : ", ") + option.dump();
  } else if (schema.contains("const")) {
    text = schema["const"].dump();
  } else {
    if (has_type(schema, "number")) text = "a number" + range(schema);
    if (has_type(schema, "integer")) text = "a whole number" + range(schema);
    if (has_type(schema, "boolean")) text = "true or false";
    if (has_type(schema, "string"))
      text = schema.value("title", "text of " + between(schema, "minLength", "maxLength") + " characters");
    if (has_type(schema, "object")) text = "an object";
    if (has_type(schema, "array"))
      text = "a list of " + between(schema, "minItems", "maxItems") + " items" +
             (schema.contains("items") ? ", each " + allowed(root, schema["items"]) : "");
    if (has_type(schema, "null")) text = join(text, "null");
  }
  if (reference.contains("x-unit")) text += " (unit " + reference["x-unit"].get<std::string>() + ")";
  return text;
}

const json* descend(const json& root, const json& reference, const std::string& step) {
  const json& schema = resolved(root, reference);
  if (schema.contains("properties") && schema["properties"].contains(step))
    return &schema["properties"][step];
  if (schema.contains("items")) return &schema["items"];
  if (schema.contains("additionalProperties") && schema["additionalProperties"].is_object())
    return &schema["additionalProperties"];
  return nullptr;
}

void explain(const json& root, const json& reference, const json& value, const std::string& pointer,
             Explanation& out) {
  const json& schema = resolved(root, reference);
  if (!scalar_fits(root, schema, value)) {
    std::string detail = shown(value) + " is not allowed: give " + allowed(root, reference);
    if (reference.contains("description")) detail += ". " + reference["description"].get<std::string>();
    return refuse(out, pointer, detail);
  }
  if (value.is_object()) explain_members(root, schema, value, pointer, out);
  if (value.is_array() &&
      (value.size() < schema.value("minItems", std::size_t{0}) ||
       (schema.contains("maxItems") && value.size() > schema["maxItems"].get<std::size_t>())))
    refuse(out, pointer, shown(value) + " is not allowed: give " + allowed(root, reference));
}

}  // namespace quicksand

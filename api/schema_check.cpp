#include "api/schema_check.hpp"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "api/case_json.hpp"
#include "api/json_text.hpp"

namespace quicksand {
namespace {

using nlohmann::json;
using Path = std::vector<std::string>;

struct CompiledSchema {
  json text = json::parse(case_schema());
  valijson::Schema rules;
  CompiledSchema() {
    valijson::SchemaParser parser;
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text), rules);
  }
};

/// Compiled once; read only afterwards.
const CompiledSchema& compiled_schema() {
  static const CompiledSchema schema;
  return schema;
}

/// The validator's path "<root>", "[bodies]", "[0]" as member names and indices.
Path plain_path(const Path& context) {
  Path path;
  for (std::size_t k = 1; k < context.size(); ++k)
    path.push_back(context[k].substr(1, context[k].size() - 2));
  return path;
}

std::string pointer_of(const Path& path) {
  std::string pointer;
  for (const std::string& step : path) pointer += "/" + pointer_step(step);
  return pointer;
}

/// Explains what is wrong at `path` by itself, if anything.
void explain_place(const json& document, const Path& path, const std::string& pointer, Explanation& out) {
  const json& root = compiled_schema().text;
  const json* schema = &root;
  const json* value = &document;
  for (const std::string& step : path) {
    schema = descend(root, *schema, step);
    if (!schema || !value->is_structured()) return;
    value = value->is_array() ? &value->at(std::stoul(step)) : &value->at(step);
  }
  explain(root, *schema, *value, pointer, out);
}

}  // namespace

Explanation check_schema(const json& document) {
  Explanation out;
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (validator.validate(compiled_schema().rules, valijson::adapters::NlohmannJsonAdapter(document),
                         &results))
    return out;
  // The validator reports every refused place and again each of its parents; a place is explained once, and
  // parents, with which nothing is wrong by themselves, drop out.
  std::set<std::string> seen;
  for (const auto& error : results) {
    if (out.faults.size() > max_faults) break;
    const Path path = plain_path(error.context);
    const std::string pointer = pointer_of(path);
    if (seen.insert(pointer).second) explain_place(document, path, pointer, out);
  }
  if (out.faults.empty()) {
    const auto& first = *results.begin();
    const std::string pointer = pointer_of(plain_path(first.context));
    out.faults.push_back({pointer, first.description});
    out.refused.insert(pointer);
  }
  return out;
}

}  // namespace quicksand

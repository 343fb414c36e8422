#pragma once
#include <nlohmann/json.hpp>

#include "api/explain.hpp"

namespace quicksand {

/// What the schema `quicksand.case/1` finds wrong in a document: one fault per place, all places. Safe to call
/// from several threads.
Explanation check_schema(const nlohmann::json& document);

}  // namespace quicksand

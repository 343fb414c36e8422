#pragma once
#include <nlohmann/json.hpp>

#include "api/explain.hpp"

namespace quicksand {

/// More faults than a person reads; bounds the work on hostile input and the size of an answer.
constexpr std::size_t max_faults = 1000;

/// What the schema `quicksand.case/1` finds wrong in a document: one fault per place, all places until there
/// are more than `max_faults`. Safe to call from several threads.
Explanation check_schema(const nlohmann::json& document);

}  // namespace quicksand

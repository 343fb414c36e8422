#pragma once
// Records of the store as the JSON of the HTTP contract.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "server/settings.hpp"
#include "server/store.hpp"

namespace quicksand {

using Json = nlohmann::ordered_json;

/// Text of a JSON value; bytes that are not UTF-8 are replaced.
std::string dump(const Json& json);

/// A text in quotes for one line of a log: what clients send cannot begin a line of its own.
std::string quoted(const std::string& text);

std::string progress_json(const Progress& progress);
Json run_json(const StoredRun& run, const Settings& settings);
Json results_json(const std::string& id, const std::vector<StoredResult>& results);

}  // namespace quicksand

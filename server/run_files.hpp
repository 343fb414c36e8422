#pragma once
#include <filesystem>
#include <vector>

#include "server/store.hpp"

namespace quicksand {

/// Removes a run's results, complete or not, with its checkpoints; its log stays. Throws
/// std::filesystem::filesystem_error.
void remove_results(const std::filesystem::path& run_folder);

/// What an interrupted run left becomes its results, if they can be opened; its checkpoints go.
void keep_unfinished_results(const std::filesystem::path& run_folder);

/// The complete results in the folder, with their sums. Throws std::runtime_error when one cannot be read.
std::vector<StoredResult> collect_results(const std::filesystem::path& run_folder);

}  // namespace quicksand

#pragma once
// The two files of a run's results in its folder, and the names that they carry while they grow.

#include <filesystem>

namespace quicksand {

inline constexpr const char *data_name = "result.vtkhdf", *view_name = "result.xdmf";

/// The name while the run goes on.
std::filesystem::path unfinished(const std::filesystem::path& folder, const char* name);

/// Both get their final names. Throws std::runtime_error, without a path.
void finish_names(const std::filesystem::path& folder);
/// Undoes that, where it was done.
void unfinish_names(const std::filesystem::path& folder);

/// Removes both, finished or not. Throws std::filesystem::filesystem_error.
void remove_named_results(const std::filesystem::path& folder);

}  // namespace quicksand

#pragma once
// Checkpoints beside the results of a run: the newest and the one before it.

#include <filesystem>
#include <string>
#include <vector>

#include "engine/run/run.hpp"

namespace quicksand {

struct StoredCheckpoint {
  std::string identity;  ///< of case and engine: only their own run may go on from it
  std::string results;   ///< how far the results go, in the result file's own terms
  Checkpoint run;
  template <class A>
  void keep(A& a) {
    a(identity, results, run);
  }
};

/// Stores it in one step: a kill or a power loss leaves this one or the one before. What the results hold
/// until then must be on disk already. Throws std::runtime_error when the disk refuses; the older ones stay.
void store_checkpoint(const std::filesystem::path& folder, std::string identity, std::string results,
                      const Checkpoint& run);

/// Those that are there, the newest first.
std::vector<std::filesystem::path> checkpoint_files(const std::filesystem::path& folder);

/// Throws std::runtime_error, in plain words, when the file is damaged or of another version.
StoredCheckpoint read_checkpoint(const std::filesystem::path& file);

void remove_checkpoints(const std::filesystem::path& folder);

}  // namespace quicksand

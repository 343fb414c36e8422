#pragma once
#include <map>
#include <memory>
#include <string>

#include "engine/results/checkpoint_file.hpp"
#include "engine/run/run.hpp"

namespace quicksand {

/// What a run must share with a checkpoint to go on from it: the resolved case, and the engine's version and
/// build, among its documents.
std::string run_identity(const std::map<std::string, std::string>& documents);

/// Removes results, finished or not, and checkpoints. Throws std::filesystem::filesystem_error.
void remove_result_files(const std::string& folder);

/// Gives what an interrupted run left its final names, if every frame can be opened; else it stays and false.
bool finish_result_files(const std::string& folder);

/// Writes a run's frames and series to `<folder>/result.vtkhdf` (VTKHDF 2.0 PolyData, temporal) and a
/// generated `<folder>/result.xdmf`, as the run goes: after each `frame` the file is flushed and a kill −9
/// leaves everything flushed so far readable. While open both carry the suffix `.part`; `close` renames
/// them. One writer thread. All members throw std::runtime_error with the folder's file name, never its
/// path, when the disk refuses.
class ResultFile final : public ResultSink {
 public:
  /// `documents`: name → text stored under `/run/<name>` (case as given, case resolved, plan, …).
  /// `resume`: a checkpoint of the run whose results the folder holds; they are cut back to it and
  /// go on.
  ResultFile(const std::string& folder, const std::map<std::string, std::string>& documents,
             const StoredCheckpoint* resume = nullptr);
  ~ResultFile() override;  ///< without `close`: leaves the `.part` files, readable
  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  void begin(const std::vector<SeriesInfo>& series) override;
  void frame(Frame frame) override;
  void sample(double time, const std::vector<double>& values) override;
  /// Beside the results, once they are on disk.
  void checkpoint(const Checkpoint& checkpoint) override;

  /// Adds or replaces `/run/<name>` (the final report), e.g. just before `close`.
  void document(const std::string& name, const std::string& text);
  /// Finishes the file and gives it its final name. No call is valid after it.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quicksand

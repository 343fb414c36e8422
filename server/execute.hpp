#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/plan/calibration.hpp"
#include "engine/run/run.hpp"

namespace quicksand {

/// One run from case text to files in `folder`: `result.vtkhdf`, `result.xdmf`, `run.json`. The single
/// entry point of the command line and of the server's workers, so both give the same bytes in the frames.
struct Execution {
  std::vector<Fault> faults;  ///< not empty: nothing was run and nothing written
  RunReport report;
};
/// Whether to go on from the folder's newest checkpoint that is whole and of this case and build.
enum class Resume {
  never,
  if_possible,  ///< else from the beginning; the monitor's log says why
  required      ///< else the run fails, code "no_checkpoint", and nothing is touched
};
/// `machine` is what numerics.budget_seconds counts by. Checkpoints are kept when the run is suspended or
/// cannot store its results, and removed otherwise.
Execution execute(const std::string& case_text, const std::optional<Preset>& preset,
                  const std::string& folder, RunMonitor& monitor, const RunOptions& options,
                  Resume resume = Resume::never, const Calibration& machine = {});

}  // namespace quicksand

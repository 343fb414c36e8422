#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/run/run.hpp"

namespace quicksand {

/// One run from case text to files in `folder`: `result.vtkhdf`, `result.xdmf`, `run.json`. The single
/// entry point of the command line and of the server's workers, so both give the same bytes in the frames.
struct Execution {
  std::vector<Fault> faults;  ///< not empty: nothing was run and nothing written
  RunReport report;
};
Execution execute(const std::string& case_text, const std::optional<Preset>& preset,
                  const std::string& folder, RunMonitor& monitor, const RunOptions& options);

}  // namespace quicksand

#pragma once
#include <string>
#include <vector>

#include "engine/study/tradeoff.hpp"
#include "server/execute.hpp"

namespace quicksand {

struct TradeoffOptions {
  std::vector<Curve> reference;  ///< empty: the run with the finest cells
  int threads = 1;               ///< 1: CPU time is that of the calling thread, whatever runs beside it
  double budget = 0;             ///< s of CPU time; 0: none
};

/// The ladder of a case measured into `folder`: `tradeoff.csv`, `tradeoff.svg`, `tradeoff.png`, `run.json`. A
/// cancelled one leaves what was measured until then; a suspended one nothing.
Execution execute_tradeoff(const std::string& case_text, const std::optional<Preset>& preset,
                           const std::string& folder, RunMonitor& monitor, const TradeoffOptions& options,
                           const Calibration& machine = {});

}  // namespace quicksand

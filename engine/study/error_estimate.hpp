#pragma once
// The error of the discretisation, told with the answer.

#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "engine/study/history.hpp"
#include "engine/study/richardson.hpp"

namespace quicksand {

struct FigureError {
  std::string name, unit;  ///< of a series, or "headline.<figure>"
  int component = 0;
  double value = 0;             ///< at the end
  double range = 0;             ///< largest less smallest value of the history, zero included
  DiscretisationError history;  ///< root mean square over time
  DiscretisationError end;      ///< of `value`
};

struct CompanionRun {
  double cell_size = 0, ratio = 1;  ///< m, –
  RunStatus status = RunStatus::succeeded;
  std::string failure;  ///< if failed
  long steps = 0;
  double wall_seconds = 0;
};

struct ErrorEstimateReport {
  std::vector<CompanionRun> companions;
  std::vector<FigureError> figures;
  std::string missing;  ///< why there are no figures; empty if there are
};

/// Two grids may agree by accident. What flows in at one reservoir flows out at others: where the order is
/// assumed, no inflow counts as nearer to the truth than all of them in the mean square.
void doubt_accidents(std::vector<FigureError>& figures);

/// Runs the companions of a scene that has been run and compares. Nothing happens, and `missing` says so, if
/// the run itself did not succeed; a cancelled or failed companion likewise.
ErrorEstimateReport estimate_error(const Scene& scene, const RunReport& report, const HistorySink& history,
                                   RunMonitor& monitor, const RunOptions& options);

}  // namespace quicksand

#pragma once
// What accuracy costs: every rung of a scene's ladder with its error and cost.

#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "engine/study/history.hpp"
#include "engine/study/ladder.hpp"

namespace quicksand {

struct RungResult {
  std::string factor, setting;
  std::string missing;  ///< why there is no error: not run for the budget, failed
  double error = 0;     ///< –, see error_against
  double cpu_seconds =
      0;  ///< the least of up to five runs of a short rung: other work only ever slows one down
  double memory_bytes = 0, steps = 0, point_steps = 0;  ///< memory as planned
  bool on_front = false;                                ///< see mark_front
  bool reference = false;                               ///< the others are measured against this one
};

struct Tradeoff {
  RunStatus status = RunStatus::succeeded;  ///< or canceled, suspended: then the rungs run until then
  std::string reference;                    ///< in words
  std::vector<RungResult> rungs;
};

/// CPU seconds and memory that the whole ladder is estimated to take, at most the budget (0: none).
struct TradeoffCost {
  double seconds = 0, memory_bytes = 0;
  std::size_t points = 0;  ///< of the largest rung
};
TradeoffCost tradeoff_cost(const Scene& scene, double budget, const Calibration& machine = {});

/// Runs the ladder. `reference`: curves by the names of the result file; empty: the run with most
/// point-steps. A rung that would take the CPU time over `budget` seconds (0: none) is not run or stopped.
/// Progress goes over the ladder as a whole, every rung a stage.
Tradeoff measure_tradeoff(const Scene& scene, const std::vector<Curve>& reference, int threads, double budget,
                          RunMonitor& monitor);

/// Largest over the figures: root mean square over time against the reference, of the largest range among the
/// reference's figures of that kind and unit, so that nothing is measured by a component that stays at
/// rounding.
double error_against(const std::vector<Curve>& curves, const std::vector<Curve>& reference);

/// Of the rungs with an error, those that nothing cheaper beats. Differences below 5 % in error or in time do
/// not count, so that a rung is not on the front by the timer's noise.
void mark_front(std::vector<RungResult>& rungs);

/// A header row, and one per rung.
std::string tradeoff_csv(const Tradeoff& tradeoff);
/// Error over CPU time with the front.
std::string tradeoff_svg(const Tradeoff& tradeoff, const std::string& title);
std::string tradeoff_png(const Tradeoff& tradeoff, const std::string& title);

/// "time,probe.base,probe.speed[1]" and rows of numbers; throws std::runtime_error with the line that is
/// none.
std::vector<Curve> curves_from_csv(const std::string& text);

}  // namespace quicksand

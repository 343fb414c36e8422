#pragma once
// What accuracy costs: variations of a scene, each with its error and cost.

#include <string>
#include <vector>

#include "engine/run/run.hpp"
#include "engine/study/history.hpp"

namespace quicksand {

/// One variation: one factor changed from the scene's own settings.
struct Rung {
  std::string factor, setting;  ///< "cell size", "0.05 m"
  Scene scene;
};

/// The scene itself first; those that mean nothing in it or do not fit it are left out. Cell sizes ×4 … ×½;
/// points per cell and axis 1, 3; the other kernel and transfer; a half and a quarter of the time step;
/// pressure tolerance 10⁻⁴ and 10⁻⁸; explicit or implicit pressure; Kw a tenth and a hundredth.
std::vector<Rung> ladder(const Scene& scene);

struct RungResult {
  std::string factor, setting;
  std::string missing;  ///< why there is no error: not run for the budget, failed
  double error = 0;     ///< –, largest over the figures: RMS over time against the reference, of its range
  double cpu_seconds = 0, memory_bytes = 0, steps = 0, point_steps = 0;  ///< memory as planned
  bool on_front = false;   ///< nothing measured is both more accurate and cheaper
  bool reference = false;  ///< the others are measured against this one
};

struct Tradeoff {
  std::string reference;  ///< in words
  std::vector<RungResult> rungs;
};

/// Runs the ladder. `reference`: curves by the names of the result file; empty: the run with most
/// point-steps. A rung that would take the CPU time over `budget` seconds (0: none) is not run or stopped.
Tradeoff measure_tradeoff(const Scene& scene, const std::vector<Curve>& reference, int threads, double budget,
                          RunMonitor& monitor);

/// CSV with a header row, and a picture of error over CPU time with the front.
std::string tradeoff_csv(const Tradeoff& tradeoff);
std::string tradeoff_svg(const Tradeoff& tradeoff, const std::string& title);

/// "time,probe.base,probe.speed[1]" and rows of numbers; throws std::runtime_error with the line that is
/// none.
std::vector<Curve> curves_from_csv(const std::string& text);

}  // namespace quicksand

#pragma once
#include <chrono>
#include <string>

#include "engine/run/run.hpp"

namespace quicksand {

/// Draws a run's progress on standard error: one moving line on a terminal, a plain line now and then
/// otherwise.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();  ///< ends the moving line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  /// Cheap; draws only when it is time to.
  void draw(const Progress& progress);
  /// Draws the last progress once more, whatever the time.
  void finish();

 private:
  void print();

  bool terminal_;
  bool drawn_ = false, pending_ = false;
  Progress last_;
  std::chrono::steady_clock::time_point next_{};
};

/// One line without its end: bar, percent, stage, simulated time, step, time step, what is left.
std::string progress_text(const Progress& progress);
/// Seconds as "0.4 s", "12 s", "3 min 05 s" or "1 h 02 min".
std::string duration_text(double seconds);

}  // namespace quicksand

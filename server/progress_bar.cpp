#include "server/progress_bar.hpp"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace quicksand {
namespace {

constexpr int bar_width = 24;
/// How often a line is drawn on a terminal and in a log.
constexpr std::chrono::milliseconds terminal_interval{200}, log_interval{5000};

}  // namespace

std::string duration_text(double seconds) {
  if (!(seconds >= 0) || seconds > 1e9) return "?";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string progress_text(const Progress& progress) {
  const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
  const auto full = static_cast<std::size_t>(std::lround(fraction * bar_width));
  return fmt::format("[{}{}] {:3.0f} %  {}  t {:.4g} of {:.4g} s  step {}  dt {:.2e} s  left {}",
                     std::string(full, '#'), std::string(bar_width - full, '.'), 100 * fraction,
                     progress.stage, progress.sim_time, progress.end_time, progress.step, progress.time_step,
                     duration_text(progress.eta_s));
}

ProgressBar::ProgressBar() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_ && drawn_) std::cerr << std::endl;
}

void ProgressBar::draw(const Progress& progress) {
  last_ = progress;
  pending_ = true;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + (terminal_ ? terminal_interval : log_interval);
  print();
}

void ProgressBar::finish() {
  if (pending_) print();
}

void ProgressBar::print() {
  const std::string line = progress_text(last_);
  if (terminal_)
    std::cerr << '\r' << line << "\033[K" << std::flush;
  else
    std::cerr << line << std::endl;
  drawn_ = true;
  pending_ = false;
}

}  // namespace quicksand

#pragma once
#include <algorithm>
#include <map>
#include <string>

#include "engine/run/run.hpp"

namespace quicksand {

/// The steps of a run so far, and what bounded them.
class StepCount {
 public:
  void add(double dt, int pressure_iterations, std::size_t points, const std::string& bound) {
    shortest_ = steps_ == 0 ? dt : std::min(shortest_, dt);
    longest_ = std::max(longest_, dt);
    ++steps_;
    point_steps_ += static_cast<double>(points);
    bound_seconds_[bound] += dt;
    iterations_ += pressure_iterations;
  }
  long steps() const { return steps_; }
  void tell(RunReport& report) const {
    report.steps = steps_;
    report.point_steps = point_steps_;
    report.time_step_min = shortest_;
    report.time_step_max = longest_;
    report.pressure_iterations_mean = steps_ ? iterations_ / static_cast<double>(steps_) : 0;
    for (const auto& [name, seconds] : bound_seconds_) report.steps_bound_by.push_back({name, seconds});
  }
  template <class A>
  void keep(A& a) {
    a(steps_, point_steps_, shortest_, longest_, iterations_, bound_seconds_);
  }

 private:
  long steps_ = 0;
  double point_steps_ = 0, shortest_ = 0, longest_ = 0, iterations_ = 0;
  std::map<std::string, double> bound_seconds_;  ///< s of simulated time
};

/// Whether a stage that may end sooner has come to rest.
class RestWatch {
 public:
  void begin() { slow_steps_ = 0; }
  /// After each step, with the points' largest speed.
  bool rests(const UntilRest& wanted, double speed, double since_begin) {
    slow_steps_ = speed < wanted.speed ? slow_steps_ + 1 : 0;
    return slow_steps_ >= kRestSteps && since_begin >= wanted.at_least;
  }
  template <class A>
  void keep(A& a) {
    a(slow_steps_);
  }

 private:
  /// Steps in a row that must be slow: a wave crosses some 80 cells in them, and a load that has just begun
  /// or a turning point does not pass for rest.
  static constexpr long kRestSteps = 100;
  long slow_steps_ = 0;
};

}  // namespace quicksand

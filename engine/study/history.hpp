#pragma once
// Histories of a run kept in memory, to be compared with those of another.

#include <string>
#include <vector>

#include "engine/run/run.hpp"

namespace quicksand {

/// One component of a series over time.
struct Curve {
  std::string name, unit;
  int component = 0;
  std::vector<double> time, value;  ///< s, unit

  double at(double t) const;  ///< linear between samples, constant beyond
  double range() const;       ///< largest less smallest value, zero included
};

/// Root mean square of a(t) − b(t) over the time that both cover, sampled at the times of `a`.
double distance(const Curve& a, const Curve& b);

/// Keeps the series of a run and hands everything on to another sink, if there is one.
class HistorySink final : public ResultSink {
 public:
  explicit HistorySink(ResultSink* next = nullptr) : next_(next) {}
  void begin(const std::vector<SeriesInfo>& series) override;
  void frame(Frame frame) override;
  void sample(double time, const std::vector<double>& values) override;
  void checkpoint(const Checkpoint& checkpoint) override;

  /// What was asked for: probes, sections, reservoirs, plates, bodies; without components that a plane lacks.
  std::vector<Curve> curves(int dimensions) const;

 private:
  ResultSink* next_;
  std::vector<SeriesInfo> info_;
  std::vector<double> time_;
  std::vector<std::vector<double>> rows_;
};

}  // namespace quicksand

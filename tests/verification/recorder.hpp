#pragma once
// Runs a scene and keeps its results in memory.

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/run/run.hpp"

namespace quicksand::test {

class Recorder : public ResultSink {
 public:
  void begin(const std::vector<SeriesInfo>& series) override { info_ = series; }
  void frame(Frame frame) override { frames.push_back(frame); }
  void sample(double time, const std::vector<double>& values) override {
    times.push_back(time);
    rows_.push_back(values);
  }

  /// History of one component of a series.
  std::vector<double> series(const std::string& name, int component = 0) const {
    int offset = component;
    for (const SeriesInfo& s : info_) {
      if (s.name == name) {
        std::vector<double> values;
        for (const auto& row : rows_) values.push_back(row[offset]);
        return values;
      }
      offset += s.components;
    }
    throw std::runtime_error("no series " + name);
  }
  double last(const std::string& name, int component = 0) const { return series(name, component).back(); }
  const std::vector<std::vector<double>>& rows() const { return rows_; }
  const std::vector<SeriesInfo>& info() const { return info_; }

  std::vector<Frame> frames;
  std::vector<double> times;

 private:
  std::vector<SeriesInfo> info_;
  std::vector<std::vector<double>> rows_;
};

inline const std::vector<float>& field(const Frame& frame, const std::string& name) {
  for (const FrameField& f : frame.fields)
    if (f.name == name) return f.values;
  throw std::runtime_error("no field " + name);
}

struct Recorded {
  RunReport report;
  Recorder results;
};
inline Recorded record(const Scene& scene, int threads = 0) {
  Recorded r;
  RunMonitor monitor;
  r.report = run(scene, r.results, monitor, {threads});
  return r;
}

inline Region box(double x0, double y0, double x1, double y1) {
  Region r;
  r.min = {x0, y0, 0};
  r.max = {x1, y1, 0};
  return r;
}

}  // namespace quicksand::test

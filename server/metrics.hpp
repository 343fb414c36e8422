#pragma once
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <memory>
#include <string>

namespace quicksand {

/// What the service counts about itself, for Prometheus. Thread-safe.
class Metrics {
 public:
  Metrics();

  /// `route`: the pattern, not the path, so that there are few of them.
  void answered(const std::string& method, const std::string& route, int status, double seconds);
  void stepped(long steps) { steps_.Increment(static_cast<double>(steps)); }
  /// A value as it is now: `quicksand_<name>`, with a label when `label` is not empty.
  void set(const std::string& name, const std::string& help, double value, const std::string& label = "",
           const std::string& label_value = "");
  /// Everything in the text format 0.0.4.
  std::string text() const;

 private:
  std::shared_ptr<prometheus::Registry> registry_ = std::make_shared<prometheus::Registry>();
  prometheus::Family<prometheus::Histogram>& latency_;
  prometheus::Family<prometheus::Counter>& answers_;
  prometheus::Counter& steps_;
};

}  // namespace quicksand

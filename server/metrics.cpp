#include "server/metrics.hpp"

#include <prometheus/text_serializer.h>

namespace quicksand {
namespace {

/// s, upper ends of the classes of HTTP latency.
const prometheus::Histogram::BucketBoundaries latency_classes{0.001, 0.005, 0.02, 0.05, 0.1, 0.5, 1, 5};

}  // namespace

Metrics::Metrics()
    : latency_(prometheus::BuildHistogram()
                   .Name("quicksand_http_seconds")
                   .Help("Time to prepare an answer; without long polls.")
                   .Register(*registry_)),
      answers_(prometheus::BuildCounter()
                   .Name("quicksand_http_answers_total")
                   .Help("Answers by route and status.")
                   .Register(*registry_)),
      steps_(prometheus::BuildCounter()
                 .Name("quicksand_steps_total")
                 .Help("Time steps computed by all runs; its rate is steps per second.")
                 .Register(*registry_)
                 .Add({})) {}

void Metrics::answered(const std::string& method, const std::string& route, int status, double seconds) {
  latency_.Add({{"method", method}, {"route", route}}, latency_classes).Observe(seconds);
  answers_.Add({{"method", method}, {"route", route}, {"status", std::to_string(status)}}).Increment();
}

void Metrics::set(const std::string& name, const std::string& help, double value, const std::string& label,
                  const std::string& label_value) {
  auto& family = prometheus::BuildGauge().Name("quicksand_" + name).Help(help).Register(*registry_);
  (label.empty() ? family.Add({}) : family.Add({{label, label_value}})).Set(value);
}

std::string Metrics::text() const { return prometheus::TextSerializer().Serialize(registry_->Collect()); }

}  // namespace quicksand

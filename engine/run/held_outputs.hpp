#pragma once
#include <utility>
#include <variant>
#include <vector>

#include "engine/run/run.hpp"

namespace quicksand {

/// Frames and samples of steps that may still be taken back.
class HeldOutputs {
 public:
  void frame(Frame frame) {
    items_.emplace_back(std::move(frame));
    ++frames_;
  }
  void sample(double time, std::vector<double> values) {
    items_.emplace_back(Sample{time, std::move(values)});
  }
  std::size_t frames() const { return frames_; }
  /// Passes them on, in order.
  void release(ResultSink& sink) {
    for (Item& item : items_) {
      if (auto* frame = std::get_if<Frame>(&item))
        sink.frame(std::move(*frame));
      else if (const auto* sample = std::get_if<Sample>(&item))
        sink.sample(sample->time, sample->values);
    }
    drop();
  }
  void drop() {
    items_.clear();
    frames_ = 0;
  }

 private:
  struct Sample {
    double time;  ///< s
    std::vector<double> values;
  };
  using Item = std::variant<Frame, Sample>;
  std::vector<Item> items_;
  std::size_t frames_ = 0;
};

}  // namespace quicksand

#pragma once
#include <atomic>
#include <cstdint>
#include <memory>

namespace quicksand {

/// At most `most` of something at a time. Thread-safe; outlives what it gave.
class Places {
 public:
  explicit Places(std::int64_t most) : most_(most) {}
  /// Holds a place until the last copy is gone; null when all are taken.
  std::shared_ptr<void> take() {
    if (++taken_ > most_) {
      --taken_;
      return nullptr;
    }
    return std::shared_ptr<Places>(this, [](Places* places) { --places->taken_; });
  }
  std::int64_t taken() const { return taken_; }

 private:
  const std::int64_t most_;
  std::atomic<std::int64_t> taken_{0};
};

}  // namespace quicksand

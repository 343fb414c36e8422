#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "engine/run/run.hpp"

namespace quicksand {

/// Passes everything on to another sink from a thread of its own, in order, so that a run goes on while its
/// frames are compressed and written. At most `kWaiting` frames and checkpoints wait; then the run does. What
/// the other sink throws is thrown here by the next call. Not for calls from several threads.
class BackgroundSink final : public ResultSink {
 public:
  explicit BackgroundSink(ResultSink& sink);
  /// Writes what is waiting. What goes wrong then is lost; `finish` tells.
  ~BackgroundSink() override;
  BackgroundSink(const BackgroundSink&) = delete;
  BackgroundSink& operator=(const BackgroundSink&) = delete;

  void begin(const std::vector<SeriesInfo>& series) override;
  void frame(Frame frame) override;
  void sample(double time, const std::vector<double>& values) override;
  void checkpoint(const Checkpoint& checkpoint) override;
  /// Frames that the other sink has.
  std::size_t frames_written() const { return written_; }
  /// Returns when all has been written. No call is valid after it.
  void finish();

 private:
  static constexpr std::size_t kWaiting = 2;
  struct Item {
    enum Kind { small, frame, checkpoint } kind;
    bool is_large() const { return kind != small; }
    std::function<void()> write;
  };
  void add(Item item);
  void work();
  void stop();

  ResultSink& sink_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> waiting_;  ///< the first one is being written
  std::size_t large_ = 0;     ///< of them
  std::atomic<std::size_t> written_ = 0;
  bool ended_ = false;
  std::exception_ptr error_;
  std::thread thread_;  ///< last: the others are there when it begins
};

}  // namespace quicksand

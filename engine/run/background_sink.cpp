#include "engine/run/background_sink.hpp"

namespace quicksand {

BackgroundSink::BackgroundSink(ResultSink& sink) : sink_(sink), thread_([this] { work(); }) {}

BackgroundSink::~BackgroundSink() { stop(); }

void BackgroundSink::begin(const std::vector<SeriesInfo>& series) {
  add({Item::small, [this, series] { sink_.begin(series); }});
}

void BackgroundSink::frame(Frame frame) {
  add({Item::frame, [this, kept = std::move(frame)]() mutable { sink_.frame(std::move(kept)); }});
}

void BackgroundSink::sample(double time, const std::vector<double>& values) {
  add({Item::small, [this, time, values] { sink_.sample(time, values); }});
}

/// Waits as a frame does: it may be as large.
void BackgroundSink::checkpoint(const Checkpoint& checkpoint) {
  add({Item::checkpoint, [this, kept = checkpoint] { sink_.checkpoint(kept); }});
}

void BackgroundSink::finish() {
  stop();
  if (error_) std::rethrow_exception(error_);
}

void BackgroundSink::add(Item item) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return error_ || !item.is_large() || large_ < kWaiting; });
  if (error_) std::rethrow_exception(error_);
  large_ += item.is_large();
  waiting_.push_back(std::move(item));
  changed_.notify_all();
}

void BackgroundSink::stop() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void BackgroundSink::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ended_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Item& item = waiting_.front();
    lock.unlock();
    std::exception_ptr error;
    try {
      item.write();
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    large_ -= item.is_large();
    written_ += item.kind == Item::frame && !error;
    waiting_.pop_front();
    if (error) {
      error_ = error;
      waiting_.clear();
    }
    changed_.notify_all();
    if (error) return;
  }
}

}  // namespace quicksand

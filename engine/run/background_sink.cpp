#include "engine/run/background_sink.hpp"

namespace quicksand {

BackgroundSink::BackgroundSink(ResultSink& sink) : sink_(sink), thread_([this] { work(); }) {}

BackgroundSink::~BackgroundSink() { stop(); }

void BackgroundSink::begin(const std::vector<SeriesInfo>& series) {
  add({false, [this, series] { sink_.begin(series); }});
}

void BackgroundSink::frame(Frame frame) {
  add({true, [this, kept = std::move(frame)]() mutable { sink_.frame(std::move(kept)); }});
}

void BackgroundSink::sample(double time, const std::vector<double>& values) {
  add({false, [this, time, values] { sink_.sample(time, values); }});
}

void BackgroundSink::finish() {
  stop();
  if (error_) std::rethrow_exception(error_);
}

void BackgroundSink::add(Item item) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return error_ || !item.is_frame || frames_ < kWaiting; });
  if (error_) std::rethrow_exception(error_);
  frames_ += item.is_frame;
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
    frames_ -= item.is_frame;
    written_ += item.is_frame && !error;
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

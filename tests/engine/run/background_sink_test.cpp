#include "engine/run/background_sink.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>

namespace quicksand {
namespace {

using namespace std::chrono_literals;

/// Keeps what it gets, taking its time over frames.
struct SlowSink : ResultSink {
  void begin(const std::vector<SeriesInfo>& series) override {
    seen.push_back("begin " + std::to_string(series.size()));
  }
  void frame(Frame f) override {
    std::this_thread::sleep_for(20ms);
    if (f.index == fail_at) throw std::runtime_error("disk full");
    seen.push_back("frame " + std::to_string(f.index));
    ++frames;
  }
  void sample(double time, const std::vector<double>& values) override {
    seen.push_back("sample " + std::to_string(static_cast<int>(time)) + " " + std::to_string(values.size()));
  }
  std::size_t fail_at = 1000;
  std::atomic<int> frames = 0;
  std::vector<std::string> seen;
};

Frame numbered(std::size_t index) {
  Frame f;
  f.index = index;
  return f;
}

TEST(BackgroundSink, PassesAllOnInOrder) {
  SlowSink slow;
  BackgroundSink sink(slow);
  sink.begin({{"a", "m", 1}});
  for (std::size_t i = 0; i < 4; ++i) sink.sample(static_cast<double>(i), {1, 2}), sink.frame(numbered(i));
  sink.finish();
  EXPECT_EQ(slow.seen, (std::vector<std::string>{"begin 1", "sample 0 2", "frame 0", "sample 1 2", "frame 1",
                                                 "sample 2 2", "frame 2", "sample 3 2", "frame 3"}));
}

TEST(BackgroundSink, RunsAheadByTwoFramesAtMost) {
  SlowSink slow;
  BackgroundSink sink(slow);
  sink.frame(numbered(0));
  EXPECT_EQ(slow.frames, 0);  // did not wait for it
  EXPECT_EQ(sink.frames_written(), 0u);
  for (std::size_t i = 1; i < 6; ++i) {
    sink.frame(numbered(i));
    EXPECT_GE(slow.frames, static_cast<int>(i) - 2);
  }
  sink.finish();
  EXPECT_EQ(slow.frames, 6);
  EXPECT_EQ(sink.frames_written(), 6u);
}

TEST(BackgroundSink, ThrowsWhatTheSinkThrew) {
  SlowSink slow;
  slow.fail_at = 1;
  BackgroundSink sink(slow);
  EXPECT_THROW(
      {
        for (std::size_t i = 0; i < 10; ++i) sink.frame(numbered(i));
      },
      std::runtime_error);
  EXPECT_THROW(sink.finish(), std::runtime_error);
  EXPECT_EQ(slow.frames, 1);
}

TEST(BackgroundSink, LeftAloneItWritesWhatWaits) {
  SlowSink slow;
  {
    BackgroundSink sink(slow);
    sink.frame(numbered(0)), sink.frame(numbered(1));
  }
  EXPECT_EQ(slow.frames, 2);
}

}  // namespace
}  // namespace quicksand

// Compiled without instrumentation when the rest is under the thread sanitizer: it does not know how the
// library, which is not instrumented either, orders tasks. What this file promises in its place is what the
// loops rely on: all before a loop, its parts in no order among themselves, all after it.

#include "engine/threads/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef QUICKSAND_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace quicksand::threads {
namespace {

/// A point in the program that others can be after.
class Milestone {
 public:
#ifdef QUICKSAND_THREAD_SANITIZER
  void pass() { __tsan_release(this); }
  void follow() { __tsan_acquire(this); }
#else
  void pass() {}
  void follow() {}
#endif
 private:
  [[maybe_unused]] char address_ = 0;
};

}  // namespace

void parallel(std::size_t n, std::size_t grain, const Part& part) {
  Milestone before, after;
  before.pass();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain), [&](const auto& range) {
    before.follow();
    part.call(part.function, range.begin(), range.end());
    after.pass();
  });
  after.follow();
}

int available() { return tbb::this_task_arena::max_concurrency(); }

void in_arena(int threads, const Part& part) {
  Milestone before, after;
  before.pass();
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    before.follow();
    part.call(part.function, 0, 1);
    after.pass();
  });
  after.follow();
}

}  // namespace quicksand::threads

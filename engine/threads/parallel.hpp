#pragma once
// The one place that deals with threads: every parallel loop goes through here, so that oneTBB is compiled
// once and the thread sanitizer can be told what orders a loop's parts before and after the rest
// (parallel.cpp).

#include <cstddef>
#include <type_traits>

namespace quicksand {

namespace threads {
/// A function of (begin, end) by its address.
struct Part {
  const void* function;
  void (*call)(const void* function, std::size_t begin, std::size_t end);
};
void parallel(std::size_t n, std::size_t grain, const Part& part);
void in_arena(int threads, const Part& part);
int available();
template <class F>
Part part_of(const F& f) {
  return {&f, [](const void* function, std::size_t begin, std::size_t end) {
            (*static_cast<const F*>(function))(begin, end);
          }};
}
}  // namespace threads

/// f(begin, end) for parts of 0 … n, of `grain` or more where there are that many. Which thread does which
/// part is open: what f writes must be its part's alone. Exceptions of f reach the caller.
template <class F>
void parallel_parts(std::size_t n, std::size_t grain, const F& f) {
  if (n > 0) threads::parallel(n, grain, threads::part_of(f));
}

/// Threads that loops here may run on.
inline int thread_count() { return threads::available(); }

/// f() with loops inside it on up to `threads` threads, the caller's among them; 0: as many as the machine
/// has.
template <class F>
void with_threads(int threads, F&& f) {
  const auto whole = [&](std::size_t, std::size_t) { f(); };
  threads::in_arena(threads, threads::part_of(whole));
}

}  // namespace quicksand

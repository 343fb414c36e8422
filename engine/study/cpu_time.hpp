#pragma once
#include <time.h>

namespace quicksand {

/// Processor time, s: of the calling thread if it does all the work, as beside it others may run in the same
/// process; else of the process.
inline double cpu_seconds(int threads = 1) {
  timespec now{};
  clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace quicksand

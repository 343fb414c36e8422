// What the machine can do at most: memory traffic by the STREAM triad, arithmetic by fused multiply-adds.
// J. McCalpin, STREAM: Sustainable Memory Bandwidth in High Performance Computers.

#include <benchmark/benchmark.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "engine/grid/lanes.hpp"
#include "tests/bench/groups.hpp"

namespace {

/// Makes a value one that the compiler does not know. benchmark::DoNotOptimize (1.7.1) lets GCC lose it.
template <class T>
void hide(T& value) {
  asm volatile("" : "+m"(value) : : "memory");
}

/// Arrays of the triad together, over the last-level cache: STREAM's rule, so that nothing is left in it.
constexpr long kTimesCache = 4;
/// Bytes at most, whatever the cache: a virtual machine is told of one that it shares with many.
constexpr long kLargest = 768L << 20, kLeast = 192L << 20;

/// Doubles on huge pages, where the system has them: what the memory can do, not what its addresses cost.
class Array {
 public:
  Array(std::size_t n, double value) {
    constexpr std::size_t kHugePage = 2 << 20;
    const std::size_t bytes = (n * sizeof(double) + kHugePage - 1) / kHugePage * kHugePage;
    data_ = static_cast<double*>(std::aligned_alloc(kHugePage, bytes));
    madvise(data_, bytes, MADV_HUGEPAGE);
    std::fill_n(data_, n, value);
  }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { std::free(data_); }
  double* data() const { return data_; }

 private:
  double* data_;
};

void triad(benchmark::State& state) {
  const long all = std::clamp(kTimesCache * sysconf(_SC_LEVEL3_CACHE_SIZE), kLeast, kLargest);
  const std::size_t n = static_cast<std::size_t>(all) / (3 * sizeof(double)) / state.threads();
  const Array a(n, 0), b(n, 1), c(n, 2);
  double q = 3;
  hide(q);
  for (auto _ : state) {
    double* const to = a.data();
    const double *const x = b.data(), *const y = c.data();
    QUICKSAND_INDEPENDENT
    for (std::size_t i = 0; i < n; ++i) to[i] = x[i] + q * y[i];
    benchmark::ClobberMemory();
  }
  const double bytes =
      3.0 * sizeof(double) * static_cast<double>(n) * static_cast<double>(state.iterations());
  state.counters["bytes_per_s"] = benchmark::Counter(bytes, benchmark::Counter::kIsRate);
}

#if defined(__AVX512F__)
constexpr int kVectorBytes = 64;
#elif defined(__AVX__)
constexpr int kVectorBytes = 32;
#else
constexpr int kVectorBytes = 16;
#endif
typedef double Vector __attribute__((vector_size(kVectorBytes)));

/// Independent sums: more than latency × units (4 × 2), fewer than registers.
constexpr int kSums = 12;

void fused_multiply_add(benchmark::State& state) {
  constexpr int kRounds = 10000;
  constexpr int kLanes = kVectorBytes / static_cast<int>(sizeof(double));
  Vector sums[kSums], factor, term;
  for (Vector& s : sums) s = Vector{} + 1.0;
  factor = Vector{} + 0.999;
  term = Vector{} + 0.001;
  hide(factor);
  hide(term);
  for (auto _ : state) {
    for (int round = 0; round < kRounds; ++round)
#pragma GCC unroll 12
      for (int k = 0; k < kSums; ++k) sums[k] = sums[k] * factor + term;
    hide(sums);
  }
  const double flops = 2.0 * kLanes * kSums * kRounds * static_cast<double>(state.iterations());
  state.counters["flops_per_s"] = benchmark::Counter(flops, benchmark::Counter::kIsRate);
}

}  // namespace

void quicksand::bench::register_machine() {
  benchmark::RegisterBenchmark("machine/triad", triad)->Iterations(10)->Threads(1)->Threads(2)->UseRealTime();
  benchmark::RegisterBenchmark("machine/fma", fused_multiply_add)->Threads(1)->Threads(2)->UseRealTime();
}

// What the machine can do at most: memory traffic by the STREAM triad, arithmetic by fused multiply-adds.
// J. McCalpin, STREAM: Sustainable Memory Bandwidth in High Performance Computers.

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

namespace {

/// Arrays of the triad together, over the last-level cache: STREAM's rule, so that nothing is left in it.
constexpr long kTimesCache = 4;
/// Bytes at most, whatever the cache: a virtual machine is told of one that it shares with many.
constexpr long kLargest = 2L << 30, kLeast = 192L << 20;

void triad(benchmark::State& state) {
  const long all = std::clamp(kTimesCache * sysconf(_SC_LEVEL3_CACHE_SIZE), kLeast, kLargest);
  const std::size_t n = static_cast<std::size_t>(all) / (3 * sizeof(double)) / state.threads();
  std::vector<double> a(n, 0), b(n, 1), c(n, 2);
  double q = 3;
  benchmark::DoNotOptimize(q);
  for (auto _ : state) {
    double *to = a.data(), *x = b.data(), *y = c.data();
#pragma GCC ivdep
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
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(term);
  for (auto _ : state) {
    for (int round = 0; round < kRounds; ++round)
#pragma GCC unroll 12
      for (int k = 0; k < kSums; ++k) sums[k] = sums[k] * factor + term;
    benchmark::DoNotOptimize(sums);
  }
  const double flops = 2.0 * kLanes * kSums * kRounds * static_cast<double>(state.iterations());
  state.counters["flops_per_s"] = benchmark::Counter(flops, benchmark::Counter::kIsRate);
}

BENCHMARK(triad)->Name("machine/triad")->Threads(1)->Threads(2)->UseRealTime();
BENCHMARK(fused_multiply_add)->Name("machine/fma")->Threads(1)->Threads(2)->UseRealTime();

}  // namespace

#pragma once
// Lanes in other orders, by shuffles of registers.

#include <utility>

#include "engine/grid/lanes.hpp"

namespace quicksand {

/// The first and the second half of the lanes.
template <int N>
QUICKSAND_INLINE Lanes<N / 2> low_half(const Lanes<N>& v) {
  if constexpr (N > kRegister)
    return v.low;
  else if constexpr (N == 8)
    return __builtin_shufflevector(v, v, 0, 1, 2, 3);
  else
    return __builtin_shufflevector(v, v, 0, 1);
}
template <int N>
QUICKSAND_INLINE Lanes<N / 2> high_half(const Lanes<N>& v) {
  if constexpr (N > kRegister)
    return v.high;
  else if constexpr (N == 8)
    return __builtin_shufflevector(v, v, 4, 5, 6, 7);
  else
    return __builtin_shufflevector(v, v, 2, 3);
}
template <int N>
QUICKSAND_INLINE Lanes<2 * N> joined(const Lanes<N>& low, const Lanes<N>& high) {
  if constexpr (2 * N > kRegister)
    return {low, high};
  else if constexpr (N == 4)
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  else
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
}

/// out[k][i] = in[i][k].
template <int N>
QUICKSAND_INLINE std::array<Lanes<N>, N> transposed(const std::array<Lanes<N>, N>& in) {
  if constexpr (N == 2 && N <= kRegister) {
    return {__builtin_shufflevector(in[0], in[1], 0, 2), __builtin_shufflevector(in[0], in[1], 1, 3)};
  } else if constexpr (N == 4 && N <= kRegister) {
    // Entries of two rows side by side: of even columns, of odd ones.
    const Lanes<N> a = __builtin_shufflevector(in[0], in[1], 0, 4, 2, 6),
                   b = __builtin_shufflevector(in[0], in[1], 1, 5, 3, 7),
                   c = __builtin_shufflevector(in[2], in[3], 0, 4, 2, 6),
                   d = __builtin_shufflevector(in[2], in[3], 1, 5, 3, 7);
    return {__builtin_shufflevector(a, c, 0, 1, 4, 5), __builtin_shufflevector(b, d, 0, 1, 4, 5),
            __builtin_shufflevector(a, c, 2, 3, 6, 7), __builtin_shufflevector(b, d, 2, 3, 6, 7)};
  } else if constexpr (N == 8 && N <= kRegister) {
    std::array<Lanes<N>, N> pair, four, out;
    each<4>([&](auto k) __attribute__((always_inline)) {
      constexpr int i = 2 * k;
      pair[i] = __builtin_shufflevector(in[i], in[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
      pair[i + 1] = __builtin_shufflevector(in[i], in[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    });
    each<4>([&](auto k) __attribute__((always_inline)) {
      // Of four rows: columns odd and odd + 4, odd + 2 and odd + 6.
      constexpr int odd = k % 2, i = k / 2 * 4;
      four[i + odd] = __builtin_shufflevector(pair[i + odd], pair[i + 2 + odd], 0, 1, 8, 9, 4, 5, 12, 13);
      four[i + 2 + odd] =
          __builtin_shufflevector(pair[i + odd], pair[i + 2 + odd], 2, 3, 10, 11, 6, 7, 14, 15);
    });
    each<4>([&](auto k) __attribute__((always_inline)) {
      out[k] = __builtin_shufflevector(four[k], four[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
      out[k + 4] = __builtin_shufflevector(four[k], four[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    });
    return out;
  } else {  // quarter by quarter
    constexpr int H = N / 2;
    std::array<Lanes<N>, N> out;
    each<4>([&](auto quarter) __attribute__((always_inline)) {
      constexpr int right = quarter % 2, below = quarter / 2;
      std::array<Lanes<H>, H> part;
      each<H>([&](auto i) __attribute__((always_inline)) {
        if constexpr (right)
          part[i] = in[i + below * H].high;
        else
          part[i] = in[i + below * H].low;
      });
      part = transposed<H>(part);
      each<H>([&](auto k) __attribute__((always_inline)) {
        if constexpr (below)
          out[k + right * H].high = part[k];
        else
          out[k + right * H].low = part[k];
      });
    });
    return out;
  }
}

/// Pairs {a, b} of N lanes one after the other: [0] those of the first half, [1] of the second.
template <int N>
QUICKSAND_INLINE std::array<Lanes<N>, 2> interleaved(const Lanes<N>& a, const Lanes<N>& b) {
  if constexpr (N == 2 && N <= kRegister)
    return {__builtin_shufflevector(a, b, 0, 2), __builtin_shufflevector(a, b, 1, 3)};
  else if constexpr (N == 4 && N <= kRegister)
    return {__builtin_shufflevector(a, b, 0, 4, 1, 5), __builtin_shufflevector(a, b, 2, 6, 3, 7)};
  else if constexpr (N == 8 && N <= kRegister)
    return {__builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11),
            __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15)};
  else {
    const auto low = interleaved<N / 2>(a.low, b.low), high = interleaved<N / 2>(a.high, b.high);
    return {Lanes<N>{low[0], low[1]}, Lanes<N>{high[0], high[1]}};
  }
}
/// The other way: [0] the first numbers of the pairs in both, [1] the second ones.
template <int N>
QUICKSAND_INLINE std::array<Lanes<N>, 2> parted(const Lanes<N>& first, const Lanes<N>& second) {
  if constexpr (N == 2 && N <= kRegister)
    return {__builtin_shufflevector(first, second, 0, 2), __builtin_shufflevector(first, second, 1, 3)};
  else if constexpr (N == 4 && N <= kRegister)
    return {__builtin_shufflevector(first, second, 0, 2, 4, 6),
            __builtin_shufflevector(first, second, 1, 3, 5, 7)};
  else if constexpr (N == 8 && N <= kRegister)
    return {__builtin_shufflevector(first, second, 0, 2, 4, 6, 8, 10, 12, 14),
            __builtin_shufflevector(first, second, 1, 3, 5, 7, 9, 11, 13, 15)};
  else {
    const auto low = parted<N / 2>(first.low, first.high), high = parted<N / 2>(second.low, second.high);
    return {Lanes<N>{low[0], high[0]}, Lanes<N>{low[1], high[1]}};
  }
}

/// Two numbers that lie one after the other, four times.
QUICKSAND_INLINE Lanes<8> four_times(const double* pair) {
#if defined(__AVX512DQ__)
  return reinterpret_cast<Lanes<8>>(_mm512_broadcast_f64x2(_mm_loadu_pd(pair)));
#elif defined(__AVX__)
  const auto twice = reinterpret_cast<Lanes<4>>(_mm256_broadcast_pd(reinterpret_cast<const __m128d*>(pair)));
  return joined<4>(twice, twice);
#else
  const Lanes<2> once = lanes_from<2>(*pair);
  const Lanes<4> twice = joined<2>(once, once);
  return joined<4>(twice, twice);
#endif
}

/// v[i][k] = first[n k + i] for k < count, else 0.
template <int n>
QUICKSAND_INLINE std::array<BatchLanes, n> columns(const double* first, int count) {
  std::array<BatchLanes, n> column;
#ifdef __AVX512F__
  std::array<BatchLanes, n> part;
  for (int m = 0; m < n; ++m) part[m] = some_lanes_from(first + m * kBatch, n * count - m * kBatch);
  const auto merge = [&]<int i, int m, int... k>(
      std::integral_constant<int, i>, std::integral_constant<int, m>, std::integer_sequence<int, k...>)
      __attribute__((always_inline)) {
    // Lane k is entry n k + i of all: in part m or in another.
    column[i] = __builtin_shufflevector(m == 0 ? part[m] : column[i], part[m],
                                        ((n * k + i) / kBatch == m ? kBatch + (n * k + i) % kBatch : k)...);
  };
  each<n * n>([&](auto im) __attribute__((always_inline)) {
    merge(std::integral_constant<int, im / n>{}, std::integral_constant<int, im % n>{},
          std::make_integer_sequence<int, kBatch>{});
  });
#else
  if constexpr (n == 2) {
    column = parted<kBatch>(some_lanes_from(first, 2 * count),
                            some_lanes_from(first + kBatch, 2 * count - kBatch));
  } else if constexpr (n == 4) {
    std::array<Lanes<4>, 4> low, high;
    each<4>([&](auto k) __attribute__((always_inline)) {
      low[k] = k < count ? lanes_from<4>(first[n * k]) : Lanes<4>{};
      high[k] = k + 4 < count ? lanes_from<4>(first[n * (k + 4)]) : Lanes<4>{};
    });
    low = transposed<4>(low), high = transposed<4>(high);
    each<4>([&](auto i) __attribute__((always_inline)) { column[i] = joined<4>(low[i], high[i]); });
  } else {
    each<n>([&](auto i) __attribute__((always_inline)) {
      column[i] = lanes_of<kBatch>([&](int k) { return k < count ? first[n * k + i] : 0.0; });
    });
  }
#endif
  return column;
}

/// The other way, for all lanes: first[n k + i] = v[i][k].
template <int n>
QUICKSAND_INLINE void put_columns(const std::array<BatchLanes, n>& v, double* first) {
  static_assert(n == 2 || n == 4);
  if constexpr (n == 2) {
    const auto pairs = interleaved<kBatch>(v[0], v[1]);
    put_lanes<kBatch>(first[0], pairs[0]), put_lanes<kBatch>(first[kBatch], pairs[1]);
  } else {
    const auto put = [&](const std::array<Lanes<4>, 4>& rows, int k) __attribute__((always_inline)) {
      const auto entries = transposed<4>(rows);
      each<4>([&](auto i) __attribute__((always_inline)) { put_lanes<4>(first[4 * (k + i)], entries[i]); });
    };
    put({low_half<kBatch>(v[0]), low_half<kBatch>(v[1]), low_half<kBatch>(v[2]), low_half<kBatch>(v[3])}, 0);
    put({high_half<kBatch>(v[0]), high_half<kBatch>(v[1]), high_half<kBatch>(v[2]), high_half<kBatch>(v[3])},
        4);
  }
}

}  // namespace quicksand

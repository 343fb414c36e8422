#pragma once
// A few doubles that one instruction works on where the processor can. Arithmetic is that of the compiler's
// vector types, element by element; where there are no such instructions it makes scalar code of it. What is
// written for any T below works on a double and on lanes alike.

#include <array>
#include <cmath>
#include <type_traits>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

/// Lanes go from function to function only inside others: how they are passed depends on the processor that a
/// file is compiled for.
#define QUICKSAND_INLINE inline __attribute__((always_inline))

/// Before a loop whose rounds do not depend on each other, whatever the compiler can see.
#ifdef __clang__
#define QUICKSAND_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define QUICKSAND_INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace quicksand {

template <int N>
struct LanesOf {
  typedef double type __attribute__((vector_size(N * sizeof(double))));
  typedef double anywhere __attribute__((vector_size(N * sizeof(double)), aligned(alignof(double))));
};
/// N doubles, N a power of two.
template <int N>
using Lanes = typename LanesOf<N>::type;

/// Points that are worked out together.
inline constexpr int kBatch = 8;
using BatchLanes = Lanes<kBatch>;

/// The N doubles that begin with `first`, which lie one after the other.
template <int N>
QUICKSAND_INLINE Lanes<N> lanes_from(const double& first) {
  return reinterpret_cast<const typename LanesOf<N>::anywhere&>(first);
}
/// The first `count` of eight doubles, and zeros: what lies behind them is not touched.
QUICKSAND_INLINE Lanes<8> some_lanes_from(const double* first, int count) {
  if (count >= 8) return lanes_from<8>(*first);
#ifdef __AVX512F__
  const auto mask = static_cast<__mmask8>(count > 0 ? (1u << count) - 1 : 0);
  return reinterpret_cast<Lanes<8>>(_mm512_maskz_loadu_pd(mask, first));
#else
  Lanes<8> v{};
  for (int k = 0; k < count; ++k) v[k] = first[k];
  return v;
#endif
}
template <int N>
QUICKSAND_INLINE void put_lanes(double& first, const Lanes<N>& v) {
  reinterpret_cast<typename LanesOf<N>::anywhere&>(first) = v;
}
template <int N>
QUICKSAND_INLINE void add_lanes(double& first, const Lanes<N>& v) {
  put_lanes<N>(first, lanes_from<N>(first) + v);
}

/// v in every lane.
template <class T>
QUICKSAND_INLINE T all_lanes(double v) {
  return T{} + v;
}
/// a where the mask is true, else b.
QUICKSAND_INLINE double where(bool mask, double a, double b) { return mask ? a : b; }
template <class Mask, class T>
QUICKSAND_INLINE T where(const Mask& mask, const T& a, const T& b) {
  return mask ? a : b;
}
template <class T>
QUICKSAND_INLINE T clamped(const T& v, const T& low, const T& high) {
  const T above = where(v > low, v, low);  // not a number becomes `low`
  return where(above < high, above, high);
}

/// out[k][i] = in[i][k].
QUICKSAND_INLINE std::array<Lanes<8>, 8> transposed(const std::array<Lanes<8>, 8>& in) {
  std::array<Lanes<8>, 8> pair, four, out;
  for (int i = 0; i < 8; i += 2) {  // entries of two rows side by side: of even columns, of odd ones
    pair[i] = __builtin_shufflevector(in[i], in[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    pair[i + 1] = __builtin_shufflevector(in[i], in[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 8; i += 4)
    for (int odd = 0; odd < 2; ++odd) {  // of four rows: columns odd and odd + 4, odd + 2 and odd + 6
      four[i + odd] = __builtin_shufflevector(pair[i + odd], pair[i + 2 + odd], 0, 1, 8, 9, 4, 5, 12, 13);
      four[i + 2 + odd] =
          __builtin_shufflevector(pair[i + odd], pair[i + 2 + odd], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int k = 0; k < 4; ++k) {
    out[k] = __builtin_shufflevector(four[k], four[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    out[k + 4] = __builtin_shufflevector(four[k], four[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
  return out;
}

QUICKSAND_INLINE double square_root(double v) { return std::sqrt(v); }
QUICKSAND_INLINE BatchLanes square_root(const BatchLanes& v) {
#ifdef __AVX512F__
  return reinterpret_cast<BatchLanes>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(v)));
#else
  BatchLanes root;
  for (int k = 0; k < kBatch; ++k) root[k] = std::sqrt(v[k]);
  return root;
#endif
}
/// 1/√v, v > 0, to the last bit or two. On AVX-512 by two steps of Newton's from the processor's estimate of
/// 14 bits: roots and divisions take as long as thirty products.
QUICKSAND_INLINE BatchLanes inverse_root(const BatchLanes& v) {
#ifdef __AVX512F__
  auto y = reinterpret_cast<BatchLanes>(_mm512_maskz_rsqrt14_pd(0xff, reinterpret_cast<__m512d>(v)));
  for (int step = 0; step < 2; ++step) y += y * (0.5 - 0.5 * v * y * y);
  return y;
#else
  return 1.0 / square_root(v);
#endif
}
/// v to a power, lane by lane.
template <class T>
QUICKSAND_INLINE T power(const T& v, double exponent) {
  if constexpr (std::is_same_v<T, double>) {
    return std::pow(v, exponent);
  } else {
    T out;
    for (int k = 0; k < kBatch; ++k) out[k] = std::pow(v[k], exponent);
    return out;
  }
}
/// Whether the mask is true in one of the first `count` lanes.
template <class Mask>
QUICKSAND_INLINE bool any_of(const Mask& mask, int count) {
  bool any = false;
  for (int k = 0; k < count; ++k) any = any || mask[k] != 0;
  return any;
}

}  // namespace quicksand

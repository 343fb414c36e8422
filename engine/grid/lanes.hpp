#pragma once
// A few doubles that one instruction works on where the processor can: the compiler's vector types up to what
// its registers hold, and pairs of halves beyond, as compilers make slow code of longer ones. What is written
// for any T below works on a double and on lanes alike.

#include <array>
#include <cmath>
#include <type_traits>
#include <utility>
#ifdef __SSE2__
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

/// f(i) for i < N, each a type with the number as its value: a loop that is none, as what is kept in an array
/// of lanes stays in registers only if every index is known before anything else is done to it.
template <int N, class F>
QUICKSAND_INLINE void each(F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, i>{}), ...);
  }
  (std::make_integer_sequence<int, N>{});
}

/// Doubles in a register.
#if defined(__AVX512F__)
inline constexpr int kRegister = 8;
#elif defined(__AVX__)
inline constexpr int kRegister = 4;
#else
inline constexpr int kRegister = 2;
#endif

template <int N>
struct Halves;
template <int N, bool fits = (N <= kRegister)>
struct LanesOf {
  typedef double type __attribute__((vector_size(N * sizeof(double))));
  typedef double anywhere __attribute__((vector_size(N * sizeof(double)), aligned(alignof(double))));
};
template <int N>
struct LanesOf<N, false> {
  using type = Halves<N>;
};
/// N doubles, N a power of two. v[k] is lane k.
template <int N>
using Lanes = typename LanesOf<N>::type;

/// Answers for the lanes of Halves, as compilers give them for their own vectors: other than 0 is true.
template <class Half>
struct HalfMasks {
  Half low, high;
  static constexpr int half = sizeof(Half) / sizeof(double);
  QUICKSAND_INLINE bool operator[](int k) const { return k < half ? low[k] != 0 : high[k - half] != 0; }
  QUICKSAND_INLINE friend HalfMasks operator&(const HalfMasks& a, const HalfMasks& b) {
    return {a.low & b.low, a.high & b.high};
  }
  QUICKSAND_INLINE friend HalfMasks operator|(const HalfMasks& a, const HalfMasks& b) {
    return {a.low | b.low, a.high | b.high};
  }
};

/// More doubles than a register holds.
template <int N>
struct Halves {
  Lanes<N / 2> low, high;
  QUICKSAND_INLINE double operator[](int k) const { return k < N / 2 ? low[k] : high[k - N / 2]; }
  QUICKSAND_INLINE friend Halves operator-(const Halves& a) { return {-a.low, -a.high}; }
#define QUICKSAND_OF_HALVES(op)                                                  \
  QUICKSAND_INLINE friend Halves operator op(const Halves& a, const Halves& b) { \
    return {a.low op b.low, a.high op b.high};                                   \
  }                                                                              \
  QUICKSAND_INLINE friend Halves operator op(double a, const Halves& b) {        \
    return {a op b.low, a op b.high};                                            \
  }                                                                              \
  QUICKSAND_INLINE friend Halves operator op(const Halves& a, double b) {        \
    return {a.low op b, a.high op b};                                            \
  }                                                                              \
  template <class T>                                                             \
  QUICKSAND_INLINE Halves& operator op##=(const T& b) {                          \
    return *this = *this op b;                                                   \
  }
  QUICKSAND_OF_HALVES(+)
  QUICKSAND_OF_HALVES(-)
  QUICKSAND_OF_HALVES(*)
  QUICKSAND_OF_HALVES(/)
#undef QUICKSAND_OF_HALVES
#define QUICKSAND_OF_HALVES(op)                                                   \
  QUICKSAND_INLINE friend auto operator op(const Halves& a, const Halves& b) {    \
    return HalfMasks<decltype(a.low op b.low)>{a.low op b.low, a.high op b.high}; \
  }                                                                               \
  QUICKSAND_INLINE friend auto operator op(const Halves& a, double b) {           \
    return HalfMasks<decltype(a.low op b)>{a.low op b, a.high op b};              \
  }
  QUICKSAND_OF_HALVES(<)
  QUICKSAND_OF_HALVES(>)
  QUICKSAND_OF_HALVES(<=)
  QUICKSAND_OF_HALVES(>=)
  QUICKSAND_OF_HALVES(!=)
#undef QUICKSAND_OF_HALVES
};

/// Points that are worked out together.
inline constexpr int kBatch = 8;
using BatchLanes = Lanes<kBatch>;

/// The N doubles that begin with `first`, which lie one after the other.
template <int N>
QUICKSAND_INLINE Lanes<N> lanes_from(const double& first) {
  if constexpr (N <= kRegister)
    return reinterpret_cast<const typename LanesOf<N>::anywhere&>(first);
  else
    return {lanes_from<N / 2>(first), lanes_from<N / 2>((&first)[N / 2])};
}
template <int N>
QUICKSAND_INLINE void put_lanes(double& first, const Lanes<N>& v) {
  if constexpr (N <= kRegister)
    reinterpret_cast<typename LanesOf<N>::anywhere&>(first) = v;
  else
    put_lanes<N / 2>(first, v.low), put_lanes<N / 2>((&first)[N / 2], v.high);
}
template <int N>
QUICKSAND_INLINE void add_lanes(double& first, const Lanes<N>& v) {
  put_lanes<N>(first, lanes_from<N>(first) + v);
}
/// f(k) in lane k, from `first` on.
template <int N, class F>
QUICKSAND_INLINE Lanes<N> lanes_of(const F& f, int first = 0) {
  if constexpr (N > kRegister)
    return {lanes_of<N / 2>(f, first), lanes_of<N / 2>(f, first + N / 2)};
  else if constexpr (N == 2)
    return Lanes<N>{f(first), f(first + 1)};
  else if constexpr (N == 4)
    return Lanes<N>{f(first), f(first + 1), f(first + 2), f(first + 3)};
  else
    return Lanes<N>{f(first),     f(first + 1), f(first + 2), f(first + 3),
                    f(first + 4), f(first + 5), f(first + 6), f(first + 7)};
}
/// The first `count` of eight doubles, and zeros: what lies behind them is not touched.
QUICKSAND_INLINE Lanes<8> some_lanes_from(const double* first, int count) {
  if (count >= 8) return lanes_from<8>(*first);
#ifdef __AVX512F__
  const auto mask = static_cast<__mmask8>(count > 0 ? (1u << count) - 1 : 0);
  return reinterpret_cast<Lanes<8>>(_mm512_maskz_loadu_pd(mask, first));
#else
  return lanes_of<8>([&](int k) { return k < count ? first[k] : 0.0; });
#endif
}
/// Lanes as numbers in memory, where the lane asked for is known only at run time.
template <int N = kBatch>
struct alignas(N * sizeof(double)) Kept {
  double at[N];
  Kept() = default;
  QUICKSAND_INLINE Kept(const Lanes<N>& v) { put_lanes<N>(at[0], v); }  // NOLINT: the same numbers
  double operator[](int k) const { return at[k]; }
  double& operator[](int k) { return at[k]; }
  QUICKSAND_INLINE Lanes<N> lanes() const { return lanes_from<N>(at[0]); }
};

/// Lane k becomes x.
template <class T>
QUICKSAND_INLINE void set_lane(T& v, int k, double x) {
  constexpr int half = sizeof(T) / sizeof(double) / 2;
  if constexpr (2 * half <= kRegister)
    v[k] = x;
  else
    k < half ? set_lane(v.low, k, x) : set_lane(v.high, k - half, x);
}

/// v in every lane.
template <class T>
QUICKSAND_INLINE T all_lanes(double v) {
  return v - T{};
}
/// 0, 1, 2, …
QUICKSAND_INLINE BatchLanes lane_numbers() {
  return lanes_of<kBatch>([](int k) { return static_cast<double>(k); });
}
/// a where the mask is true, else b.
QUICKSAND_INLINE double where(bool mask, double a, double b) { return mask ? a : b; }
template <class Mask, class T>
QUICKSAND_INLINE T where(const Mask& mask, const T& a, const T& b) {
  return mask ? a : b;
}
template <class Half, int N>
QUICKSAND_INLINE Halves<N> where(const HalfMasks<Half>& mask, const Halves<N>& a, const Halves<N>& b) {
  return {where(mask.low, a.low, b.low), where(mask.high, a.high, b.high)};
}
template <class T>
QUICKSAND_INLINE T clamped(const T& v, const T& low, const T& high) {
  const T above = where(v > low, v, low);  // not a number becomes `low`
  return where(above < high, above, high);
}

QUICKSAND_INLINE double square_root(double v) { return std::sqrt(v); }
template <class T>
QUICKSAND_INLINE T square_root(const T& v) {
  if constexpr (sizeof(T) > kRegister * sizeof(double)) {
    return {square_root(v.low), square_root(v.high)};
  } else {
#if defined(__AVX512F__)
    return reinterpret_cast<T>(_mm512_maskz_sqrt_pd(0xff, reinterpret_cast<__m512d>(v)));
#elif defined(__AVX__)
    return reinterpret_cast<T>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(v)));
#elif defined(__SSE2__)
    return reinterpret_cast<T>(_mm_sqrt_pd(reinterpret_cast<__m128d>(v)));
#else
    return T{std::sqrt(v[0]), std::sqrt(v[1])};
#endif
  }
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
  if constexpr (std::is_same_v<T, double>)
    return std::pow(v, exponent);
  else
    return lanes_of<kBatch>([&](int k) { return std::pow(v[k], exponent); });
}
/// Bit k is set where lane k of the mask is true.
template <class Mask>
QUICKSAND_INLINE unsigned bits_of(const Mask& mask) {
  if constexpr (sizeof(Mask) > kRegister * sizeof(double)) {
    return bits_of(mask.low) | bits_of(mask.high) << sizeof(mask.low) / sizeof(double);
  } else {
#if defined(__AVX512DQ__)
    return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX__) && !defined(__AVX512F__)
    return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask)));
#else
    unsigned bits = 0;
    for (int k = 0; k < kRegister; ++k) bits |= (mask[k] != 0 ? 1u : 0u) << k;
    return bits;
#endif
  }
}
/// bits_of the first `count` lanes.
inline unsigned first_bits(int count) { return (1u << count) - 1; }
/// Whether the mask is true in one of the first `count` lanes.
template <class Mask>
QUICKSAND_INLINE bool any_of(const Mask& mask, int count) {
  return (bits_of(mask) & first_bits(count)) != 0;
}

}  // namespace quicksand

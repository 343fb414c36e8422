#pragma once
// Loops over long vectors: in parallel where that pays, with sums in a fixed order.

#include <algorithm>
#include <vector>

#include "engine/threads/parallel.hpp"

namespace quicksand {

/// Entries of a chunk. Shorter vectors are gone through by one thread; sums are taken chunk by chunk in any
/// case, so that they do not depend on it.
inline constexpr std::size_t kChunk = 2048;

/// f(begin, end) for the chunks of 0 … n.
template <class F>
void for_chunks(std::size_t n, F&& f) {
  const std::size_t chunks = (n + kChunk - 1) / kChunk;
  const auto one = [&](std::size_t c) { f(c * kChunk, std::min(n, (c + 1) * kChunk)); };
  if (chunks < 3)
    for (std::size_t c = 0; c < chunks; ++c) one(c);
  else
    parallel_parts(chunks, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) one(c);
    });
}

/// Combines f(begin, end) of all chunks, in their order.
template <class T, class F, class Combine>
T reduce_chunks(std::size_t n, T start, F&& f, Combine&& combine) {
  const std::size_t chunks = (n + kChunk - 1) / kChunk;
  std::vector<T> part(chunks);
  for_chunks(n, [&](std::size_t begin, std::size_t end) { part[begin / kChunk] = f(begin, end); });
  for (const T& p : part) start = combine(start, p);
  return start;
}

}  // namespace quicksand

#pragma once
#include <cstdint>
#include <string>

namespace quicksand {

/// Part of a file that a `Range` header asks for.
struct RangeAnswer {
  enum class Kind {
    whole,          ///< no range, or one that RFC 9110 lets us ignore: other unit, malformed, several ranges
    part,           ///< bytes first…last, inclusive
    unsatisfiable,  ///< 416
  } kind = Kind::whole;
  std::uint64_t first = 0, last = 0;
};

/// `header`: value of `Range`, empty when absent; `size`: bytes of the file.
RangeAnswer parse_range(const std::string& header, std::uint64_t size);

enum class EtagComparison {
  weak,    ///< If-None-Match: W/ does not matter
  strong,  ///< If-Range: both must be strong
};
/// Whether a list of entity tags (or `*`) names `etag`.
bool etag_matches(const std::string& header, const std::string& etag, EtagComparison comparison);

}  // namespace quicksand

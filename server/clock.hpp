#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace quicksand {

/// Milliseconds since 1970-01-01 UTC.
using Milliseconds = std::int64_t;
using Clock = std::function<Milliseconds()>;

Milliseconds utc_now();

/// RFC 3339 in UTC: 2024-05-06T07:08:09.123Z
std::string rfc3339(Milliseconds time);
/// Reads `YYYY-MM-DDTHH:MM:SS[.fraction]Z`; empty for anything else, and for times before
/// 1970.
std::optional<Milliseconds> parse_rfc3339(const std::string& text);

}  // namespace quicksand

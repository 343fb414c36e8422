// Any bytes as the parts of a request and as settings: the service's own parsers, each held to what it
// promises.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/clock.hpp"
#include "server/http_range.hpp"
#include "server/settings.hpp"

namespace {

void require(bool holds) {
  if (!holds) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace quicksand;
  if (size < 8) return 0;
  std::uint64_t length = 0;
  for (int i = 0; i < 8; ++i) length = length << 8 | bytes[i];
  const std::string text(reinterpret_cast<const char*>(bytes) + 8, size - 8);

  const RangeAnswer range = parse_range(text, length);
  if (range.kind == RangeAnswer::Kind::part) require(range.first <= range.last && range.last < length);
  etag_matches(text, "\"abc\"", EtagComparison::weak);
  require(!etag_matches(text, "W/\"abc\"", EtagComparison::strong));
  if (const auto time = parse_rfc3339(text)) require(parse_rfc3339(rfc3339(*time)).has_value());

  Settings settings;
  read_settings(text, settings);
  for (const Setting& setting : settings_table())
    if (const auto count = std::get_if<Count Settings::*>(&setting.place))
      require(settings.*(*count) >= setting.least && settings.*(*count) <= setting.most);
  return 0;
}

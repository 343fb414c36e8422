#include "server/http_range.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

namespace quicksand {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Digits only; a number beyond 2⁶⁴ counts as the largest.
std::optional<std::uint64_t> parse_number(const std::string& text) {
  if (text.empty() || text.find_first_not_of("0123456789") != std::string::npos) return {};
  std::uint64_t number = 0;
  const auto end = text.data() + text.size();
  if (std::from_chars(text.data(), end, number).ec == std::errc::result_out_of_range) return UINT64_MAX;
  return number;
}

}  // namespace

RangeAnswer parse_range(const std::string& header, std::uint64_t size) {
  const std::string range = trimmed(header);
  const auto dash = range.find('-');
  if (range.rfind("bytes=", 0) != 0 || dash == std::string::npos) return {};
  const std::string from = trimmed(range.substr(6, dash - 6)), to = trimmed(range.substr(dash + 1));
  const auto first = parse_number(from), last = parse_number(to);
  if ((!from.empty() && !first) || (!to.empty() && !last) || (!first && !last)) return {};
  if (!first) {  // the last so many bytes
    if (*last == 0 || size == 0) return {RangeAnswer::Kind::unsatisfiable};
    return {RangeAnswer::Kind::part, size - std::min(*last, size), size - 1};
  }
  if (last && *last < *first) return {};
  if (*first >= size) return {RangeAnswer::Kind::unsatisfiable};
  return {RangeAnswer::Kind::part, *first, last ? std::min(*last, size - 1) : size - 1};
}

bool etag_matches(const std::string& header, const std::string& etag, EtagComparison comparison) {
  const auto opaque = [](const std::string& tag) { return tag.rfind("W/", 0) == 0 ? tag.substr(2) : tag; };
  if (comparison == EtagComparison::strong && etag.rfind("W/", 0) == 0) return false;
  if (trimmed(header) == "*") return true;
  std::size_t begin = 0;
  while (begin <= header.size()) {  // our tags hold no commas
    const auto comma = std::min(header.find(',', begin), header.size());
    const std::string tag = trimmed(header.substr(begin, comma - begin));
    if (comparison == EtagComparison::strong ? tag == etag : opaque(tag) == opaque(etag)) return true;
    begin = comma + 1;
  }
  return false;
}

}  // namespace quicksand

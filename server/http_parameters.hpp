#pragma once
// Query parameters as values; what is malformed is refused with 400.

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include "server/http_problem.hpp"
#include "server/service.hpp"

namespace quicksand {

template <typename Number>
std::optional<Number> whole_number(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return number;
}

template <typename Number>
Number checked_number(const Call& call, const char* name, Number least, Number most, Number absent) {
  if (!call.request.has_param(name)) return absent;
  const auto number = whole_number<Number>(call.parameter(name));
  if (!number || *number < least || *number > most)
    fail(400, std::string(name) + ": a whole number from " + std::to_string(least) + " to " +
                  std::to_string(most));
  return *number;
}

/// The parts of a list "a,b,c".
inline std::vector<std::string> words(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const auto comma = std::min(list.find(',', begin), list.size());
    parts.push_back(list.substr(begin, comma - begin));
    begin = comma + 1;
  }
  return parts;
}

}  // namespace quicksand

#include "server/settings.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <sstream>

namespace quicksand {
namespace {

constexpr std::string_view size_suffixes = "kMGT";

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// A whole number; of bytes also with k, M, G or T (powers of 1024).
std::optional<Count> parse_count(const std::string& text, Setting::Kind kind) {
  Count count = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, count);
  if (error != std::errc{}) return {};
  if (rest == end) return count;
  const auto power = size_suffixes.find(*rest);
  if (kind != Setting::Kind::bytes || rest + 1 != end || power == std::string_view::npos) return {};
  const int shift = 10 * (static_cast<int>(power) + 1);
  if (count < 0 || count > (INT64_MAX >> shift)) return {};
  return count << shift;
}

std::string print_count(Count count, Setting::Kind kind) {
  std::size_t power = 0;
  while (kind == Setting::Kind::bytes && power < size_suffixes.size() && count != 0 && count % 1024 == 0) {
    count /= 1024;
    ++power;
  }
  return std::to_string(count) + (power > 0 ? std::string(1, size_suffixes[power - 1]) : "");
}

std::string print_value(const Settings& settings, const Setting& setting) {
  if (const auto text = std::get_if<std::string Settings::*>(&setting.place)) return settings.*(*text);
  return print_count(settings.*std::get<Count Settings::*>(setting.place), setting.kind);
}

bool is_log_level(const std::string& word) {
  return word == "debug" || word == "info" || word == "warning" || word == "error";
}

std::string range_text(const Setting& setting) {
  return print_count(setting.least, setting.kind) + " to " + print_count(setting.most, setting.kind);
}

}  // namespace

std::string set(Settings& settings, const std::string& name, const std::string& value) {
  const auto& table = settings_table();
  const auto setting = std::find_if(table.begin(), table.end(), [&](auto& s) { return name == s.name; });
  if (setting == table.end()) return "there is no setting \"" + name + "\"";
  if (const auto text = std::get_if<std::string Settings::*>(&setting->place)) {
    if (*text == &Settings::log_level && !is_log_level(value))
      return name + " = " + value + ": debug, info, warning or error";
    settings.*(*text) = value;
    return "";
  }
  const auto count = parse_count(value, setting->kind);
  if (!count || *count < setting->least || *count > setting->most)
    return name + " = " + value + ": a whole number from " + range_text(*setting) +
           (setting->kind == Setting::Kind::bytes ? ", in bytes or with k, M, G or T" : "");
  settings.*std::get<Count Settings::*>(setting->place) = *count;
  return "";
}

std::vector<Fault> read_settings(const std::string& text, Settings& settings) {
  std::vector<Fault> faults;
  std::set<std::string> seen;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string where = "line " + std::to_string(++number);
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const auto equals = line.find('=');
    if (equals == std::string::npos) {
      faults.push_back({where, "\"" + line + "\": write name = value"});
      continue;
    }
    const std::string name = trimmed(line.substr(0, equals));
    std::string wrong = set(settings, name, trimmed(line.substr(equals + 1)));
    if (wrong.empty() && !seen.insert(name).second) wrong = name + " is set twice: keep one of them";
    if (!wrong.empty()) faults.push_back({where, wrong});
  }
  return faults;
}

std::string print_settings(const Settings& settings) {
  std::string text =
      "# Settings of quicksand serve. Sizes are bytes, or with k, M, G or T (powers of 1024).\n";
  for (const Setting& setting : settings_table()) {
    text += "\n# ";
    for (const char* c = setting.help; *c != '\0'; ++c) text += *c == '\n' ? "\n# " : std::string(1, *c);
    if (setting.kind != Setting::Kind::text) text += " (" + range_text(setting) + ")";
    text += std::string("\n") + setting.name + " = " + print_value(settings, setting) + "\n";
  }
  return text;
}

std::string named_limit(const Settings& settings, Count Settings::*place) {
  for (const Setting& setting : settings_table())
    if (const auto count = std::get_if<Count Settings::*>(&setting.place); count && *count == place)
      return print_count(settings.*place, setting.kind) + " (" + setting.name + ")";
  return std::to_string(settings.*place);
}

}  // namespace quicksand

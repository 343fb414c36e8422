#include "api/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace quicksand {
namespace {

using nlohmann::json;

/// Builds a value from parser events and keeps track of where it is, so that every fault has a pointer.
class StrictBuilder final : public nlohmann::json_sax<json> {
 public:
  explicit StrictBuilder(const std::string& text) : text_(text) {}

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override {
    constexpr double exact = 9007199254740992.0;  // 2^53: up to here every whole double is exact
    if (std::abs(value) <= exact && value == std::floor(value)) return add(static_cast<std::int64_t>(value));
    return add(value);
  }
  bool string(string_t& value) override { return plain(value, "string") && add(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // does not occur in text

  bool start_object(std::size_t) override { return open(json::object()); }
  bool start_array(std::size_t) override { return open(json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& key) override {
    if (!plain(key, "key")) return false;
    Level& level = levels_.back();
    level.step = pointer_step(key);
    level.key = key;
    level.skip = !level.seen.insert(key).second;
    if (level.skip) faults.push_back({here(), "the key \"" + key + "\" is given twice: keep one of them"});
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    const std::size_t at = std::min(position > 0 ? position - 1 : 0, text_.size());
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t before = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
    const std::size_t column = before == std::string::npos ? at + 1 : at - before;
    faults.push_back({here(), "not valid JSON at line " + std::to_string(line) + ", column " +
                                  std::to_string(column) + ": " + reason(error.what())});
    return false;
  }

  json root;
  std::vector<Fault> faults;

 private:
  struct Level {
    json* value;  ///< null below a duplicate key: read, but not stored
    std::set<std::string> seen;
    std::string key, step;
    bool skip = false;
  };

  std::string here() const {
    std::string pointer;
    for (const Level& level : levels_) pointer += level.step.empty() ? "" : "/" + level.step;
    return pointer;
  }

  /// The parser's own words without its code and position, and without echoing long input.
  static std::string reason(std::string what) {
    const auto start = what.find(": ");
    if (start != std::string::npos) what.erase(0, start + 2);
    if (what.rfind("syntax error while parsing ", 0) == 0) what.erase(0, 13);
    for (const char* close : {"expected '}'", "expected ']'"})  // it expects no less a comma
      if (what.ends_with(close)) what.insert(what.size() - 3, "',' or ");
    for (char& c : what)
      if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
    constexpr std::size_t longest = 200;
    return what.size() > longest ? what.substr(0, longest) + " …" : what;
  }

  bool plain(const std::string& text, const char* what) {
    if (text.size() > max_string) {
      faults.push_back({here(), std::string("a ") + what + " of " + std::to_string(text.size()) +
                                    " bytes: at most " + std::to_string(max_string) + " are allowed"});
      return false;
    }
    if (text.find('\0') != std::string::npos) {
      faults.push_back({here(), std::string("a ") + what + " holds a NUL character: remove it"});
      return false;
    }
    return true;
  }

  /// Stores a value in the innermost open container; answers where, or null below a duplicate key.
  json* place(json&& value) {
    if (levels_.empty()) return &(root = std::move(value));
    Level& level = levels_.back();
    if (!level.value || level.skip) return nullptr;
    if (level.value->is_object()) return &((*level.value)[level.key] = std::move(value));
    level.value->push_back(std::move(value));
    return &level.value->back();
  }

  void count_item() {
    if (levels_.empty()) return;
    Level& level = levels_.back();
    if (level.value && level.value->is_array()) level.step = std::to_string(level.value->size());
  }

  template <typename Value>
  bool add(Value&& value) {
    count_item();
    place(json(std::forward<Value>(value)));
    return true;
  }

  bool open(json&& container) {
    count_item();
    if (levels_.size() >= max_depth) {
      faults.push_back({here(), "nested deeper than " + std::to_string(max_depth) + " levels: simplify"});
      return false;
    }
    levels_.push_back({place(std::move(container)), {}, {}, {}, false});
    return true;
  }

  bool close() {
    levels_.pop_back();
    return true;
  }

  const std::string& text_;
  std::vector<Level> levels_;
};

}  // namespace

std::string pointer_step(const std::string& key) {
  std::string step;
  for (const char c : key) step += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return step;
}

JsonText read_json(const std::string& text) {
  StrictBuilder builder(text);
  JsonText result;
  result.complete = json::sax_parse(text, &builder);
  result.faults = std::move(builder.faults);
  if (result.complete) result.value = std::move(builder.root);
  return result;
}

}  // namespace quicksand

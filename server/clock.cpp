#include "server/clock.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <chrono>
#include <ctime>

namespace quicksand {

Milliseconds utc_now() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
}

std::string rfc3339(Milliseconds time) {
  const std::time_t seconds = time / 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> date{};
  std::strftime(date.data(), date.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  return fmt::format("{}.{:03}Z", date.data(), time % 1000);
}

std::optional<Milliseconds> parse_rfc3339(const std::string& text) {
  std::tm parts{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (rest == nullptr) return {};
  Milliseconds fraction = 0;
  if (*rest == '.') {
    Milliseconds unit = 100;  // digits after the third are below our resolution
    for (++rest; *rest >= '0' && *rest <= '9'; ++rest, unit /= 10) fraction += (*rest - '0') * unit;
  }
  if (*rest != 'Z' || rest + 1 != text.data() + text.size()) return {};
  const Milliseconds seconds = timegm(&parts);
  if (seconds < 0) return {};
  return seconds * 1000 + fraction;
}

}  // namespace quicksand

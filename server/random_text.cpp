#include "server/random_text.hpp"

#include <sys/random.h>

#include <stdexcept>
#include <vector>

namespace quicksand {

std::string random_hex(std::size_t bytes) {
  std::vector<unsigned char> bits(bytes);
  if (getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
    throw std::runtime_error("no random numbers");
  static constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char b : bits) {
    text += digits[b >> 4];
    text += digits[b & 15];
  }
  return text;
}

}  // namespace quicksand

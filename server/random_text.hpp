#pragma once
#include <string>

namespace quicksand {

/// `bytes` random bytes of the system as hexadecimal digits, fit for secrets. Throws std::runtime_error when
/// there are none.
std::string random_hex(std::size_t bytes);

}  // namespace quicksand

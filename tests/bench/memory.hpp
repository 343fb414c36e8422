#pragma once
// Memory of this process as the system sees it, in bytes. Linux.

#include <malloc.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>
#include <string>

namespace quicksand::bench {

/// A field of /proc/self/status that is given in kB.
inline double status_bytes(const std::string& field) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.compare(0, field.size() + 1, field + ":") == 0)
      return 1024 * std::stod(line.substr(field.size() + 1));
  return 0;
}

/// Resident now, after giving back what is free.
inline double resident_bytes() {
  malloc_trim(0);
  return status_bytes("VmRSS");
}

/// Largest since `forget_peak`.
inline double peak_bytes() { return status_bytes("VmHWM"); }
inline void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

}  // namespace quicksand::bench

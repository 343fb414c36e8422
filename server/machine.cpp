#include "server/machine.hpp"

#include <sys/sysinfo.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

namespace quicksand {

double machine_memory() {
  struct sysinfo facts {};
  sysinfo(&facts);
  const double whole = static_cast<double>(facts.totalram) * static_cast<double>(facts.mem_unit);
  std::ifstream limit("/sys/fs/cgroup/memory.max");  // a container's or unit's share
  double share = 0;
  return limit >> share ? std::min(whole, share) : whole;
}

double resident_memory() {
  std::ifstream facts("/proc/self/statm");
  double pages = 0;
  facts >> pages >> pages;
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

int machine_cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace quicksand

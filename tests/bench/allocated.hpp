#pragma once
// What a state holds, by part: the bytes of its arrays, of those over the lattice the pages that are there.

#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <utility>
#include <vector>

#include "engine/step/state.hpp"

namespace quicksand::bench {

using Allocated = std::vector<std::pair<std::string, double>>;  ///< part, bytes

template <class T>
double bytes_of(const std::vector<T>& v) {
  return static_cast<double>(v.capacity() * sizeof(T));
}
template <class T>
double bytes_of(const Field<T>& field) {
  if (field.empty()) return 0;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> there((field.capacity() * sizeof(T) + page - 1) / page);
  // Fields begin on a page.
  if (mincore(const_cast<T*>(field.data()), field.capacity() * sizeof(T), there.data()) != 0) return 0;
  double pages = 0;
  for (const unsigned char p : there) pages += p & 1;
  return pages * static_cast<double>(page);
}
inline double bytes_of(const FaceSumFields& sums) {
  return bytes_of(sums.soil) + bytes_of(sums.force) + bytes_of(sums.stress) + bytes_of(sums.room) +
         bytes_of(sums.water);
}
template <class Array, std::size_t N>
double bytes_of(const std::array<Array, N>& arrays) {
  double sum = 0;
  for (const auto& v : arrays) sum += bytes_of(v);
  return sum;
}
template <class... Arrays>
double bytes_of_all(const Arrays&... arrays) {
  return (0.0 + ... + bytes_of(arrays));
}
template <class Set>
double bytes_of_points(const Set& set) {
  double sum = 0;
  for_arrays(const_cast<Set&>(set), [&](const auto& v) { sum += bytes_of(v); });
  return sum;
}

template <int D>
Allocated allocated(const State<D>& s) {
  const PressureSystem<D>& m = s.pressure_system;
  return {
      {"soil points", bytes_of_points(s.soil) + bytes_of_points(s.fixed)},
      {"water points", bytes_of_points(s.water)},
      {"order", bytes_of_all(s.soil_blocks.order, s.soil_blocks.begin, s.soil_blocks.key,
                             s.water_blocks.order, s.water_blocks.begin, s.water_blocks.key)},
      {"faces", bytes_of_all(s.sums, s.image, s.follower, s.flow, s.rest, s.flux, s.flux_response, s.speeds,
                             s.fixed_face, s.port_of)},
      {"cells",
       bytes_of_all(s.cell_sums, s.fixed_cell, s.cell, s.pressure, s.pressure_old, s.pressure_before)},
      {"pressure system",
       bytes_of_all(m.cell, m.matrix.diagonal, m.matrix.coupling, m.neighbor, m.rhs, m.solution, m.change)},
      {"multigrid", s.multigrid.bytes()},
  };
}

}  // namespace quicksand::bench

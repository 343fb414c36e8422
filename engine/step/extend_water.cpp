// The water's velocity a little way into the air next to its surface, for the points whose kernels reach
// there.

#include <atomic>
#include <cmath>

#include "engine/step/phases.hpp"

namespace quicksand {
namespace {

/// Whether a wall lies between two neighbouring faces of component d, `side` of `face` along axis a ≠ d.
template <int D>
bool wall_between(const State<D>& s, int d, int face, int a, int side) {
  const int offset = side * s.grid.stride[a];
  return s.water_walls.closed(a, face + offset) || s.water_walls.closed(a, face - s.grid.stride[d] + offset);
}

template <int D>
bool holds_water(const State<D>& s, int d, int face) {
  return s.sums[d].water[face].mass > kMassCutoff * s.constants.water_density * s.volume.face(d, face);
}

/// Velocity of the water at a face beyond the water surface, from the neighbours that know better; or false.
/// What is there moves with them; but when it is much faster or slower it is another body, a drop that
/// passes, and keeps its own velocity, accelerated as they are: dragged along, it would be struck again in
/// every step by the points of both that its face is the mean of, without end.
template <int D>
bool extrapolate(const State<D>& s, int d, int face, std::uint8_t level, double wave, double& value) {
  double sum = 0, change = 0;
  int count = 0, changes = 0;
  for (int a = 0; a < D; ++a)
    for (int side : {0, 1}) {
      if (a != d && wall_between(s, d, face, a, side)) continue;
      const int other = face + (2 * side - 1) * s.grid.stride[a];
      const FaceFlow& o = s.flow[d][other];
      // Faces of this level may be written meanwhile; their flag is then ≥ level or still 0.
      const std::uint8_t wet =
          std::atomic_ref(const_cast<std::uint8_t&>(o.wet)).load(std::memory_order_relaxed);
      if (wet == 0 || wet >= level || s.water_walls.closed(d, other)) continue;
      const FaceSpeeds& v = s.speeds[d][other];
      sum += v.water;
      ++count;
      if (!holds_water(s, d, other)) continue;
      change += v.water - v.water_old;
      ++changes;
    }
  if (!count) return false;
  value = sum / count;
  if (changes == 0 || !holds_water(s, d, face)) return true;
  const double own = s.speeds[d][face].water_old + change / changes;
  if (std::abs(value - own) > wave) value = own;
  return true;
}

}  // namespace

template <int D>
void extend_water(State<D>& s, const std::vector<std::uint8_t>& blocks) {
  const double wave = cell_wave(s);
  // A kernel reaches 1½ cells: two rings of faces beyond the last wet one.
  for (const std::uint8_t level : {std::uint8_t{2}, std::uint8_t{3}})
    s.blocks.all([&](int b) {
      if (!blocks[b]) return;
      s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
        for (int d = 0; d < D; ++d) {
          FaceFlow& f = s.flow[d][face];
          if (f.wet || s.water_walls.closed(d, face) || in_plate(s, d, face)) continue;
          if (!may_be_extended(s, d, face)) continue;
          double v;
          if (extrapolate(s, d, face, level, wave, v)) {
            s.speeds[d][face].water = v;
            std::atomic_ref(f.wet).store(level, std::memory_order_relaxed);
          }
        }
      });
    });
}

template void extend_water<2>(State<2>&, const std::vector<std::uint8_t>&);
template void extend_water<3>(State<3>&, const std::vector<std::uint8_t>&);

}  // namespace quicksand

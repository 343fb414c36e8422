#pragma once
// Faces of the common kind, several at a time. No wall, plate, port or water surface is in reach of a plain
// block (State::plain), so that nothing has to be asked of its faces one by one. The same equations face by
// face are in velocities.cpp, viscosity.cpp and impulse.cpp.

#include "engine/grid/shuffles.hpp"
#include "engine/step/phases.hpp"

namespace quicksand {

/// Eight faces of one component: two rows of four along x, by the index of the first of each.
struct FaceRows {
  int first, second;
  int face(int k) const { return k < 4 ? first + k : second + k - 4; }
  FaceRows moved(int by) const { return {first + by, second + by}; }
};

/// f(rows, d) for the faces of a plain block.
template <int D, class F>
QUICKSAND_INLINE void for_face_rows(const State<D>& s, int block, F&& f) {
  static_assert(Blocks<D>::kEdge == 4);
  const int low = s.grid.index(s.blocks.low(block));
  for (int z = 0; z < (D == 3 ? 4 : 1); ++z)
    for (int y = 0; y < 4; y += 2) {
      const int first = low + y * s.grid.stride[1] + (D == 3 ? z * s.grid.stride[D - 1] : 0);
      for (int d = 0; d < D; ++d) f(FaceRows{first, first + s.grid.stride[1]}, d);
    }
}

/// Asks for what lies on faces, so that it is there when it is read, or written to.
template <bool to_write = false, class T>
QUICKSAND_INLINE void ask_for(const Field<T>& field, const FaceRows& rows) {
  constexpr std::ptrdiff_t size = sizeof(T), line = 64;
  for (const int first : {rows.first, rows.second})
    for (std::ptrdiff_t at = first * size / line * line; at < (first + 4) * size; at += line)
      __builtin_prefetch(reinterpret_cast<const char*>(field.data()) + at, to_write);
}
/// The sums of the block after this one, mostly the next to be worked on: blocks are narrow, and the
/// processor does not foresee by itself where rows go on.
template <int D>
QUICKSAND_INLINE void ask_for_next_sums(const State<D>& s, int block) {
  if (block + 1 == s.blocks.count() || !s.plain[block + 1]) return;
  for_face_rows(
      s, block + 1, [&](const FaceRows& rows, int d) __attribute__((always_inline)) {
        s.sums[d].each([&](const auto& field) __attribute__((always_inline)) { ask_for(field, rows); });
      });
}

/// Numbers of eight faces.
QUICKSAND_INLINE BatchLanes rows_of(const Field<double>& field, const FaceRows& rows) {
  return joined<4>(lanes_from<4>(field[rows.first]), lanes_from<4>(field[rows.second]));
}
/// Pairs of eight faces, [0] the first numbers of them and [1] the second.
template <class Pair>
QUICKSAND_INLINE std::array<BatchLanes, 2> pairs_of(const Field<Pair>& field, const FaceRows& rows) {
  return parted<kBatch>(lanes_from<kBatch>(reinterpret_cast<const double&>(field[rows.first])),
                        lanes_from<kBatch>(reinterpret_cast<const double&>(field[rows.second])));
}

/// FaceSums of eight faces, member by member: those that the scene has.
template <class P>
struct SumsInLanes {
  BatchLanes soil_mass, grains, soil_momentum, soil_force, resistivity, water_mass, water_momentum;

  QUICKSAND_INLINE SumsInLanes(const FaceSumFields& sums, const FaceRows& rows) {
    if constexpr (P::soil) {
      const auto mass = pairs_of(sums.soil, rows);
      soil_mass = mass[0], soil_momentum = mass[1];
    }
    if constexpr (P::soil && !P::water) soil_force = rows_of(sums.stress, rows);
    if constexpr (P::water) {
      const auto mass = pairs_of(sums.water, rows);
      water_mass = mass[0], water_momentum = mass[1];
    }
    if constexpr (P::soil && P::water) {
      const auto force = pairs_of(sums.force, rows);
      resistivity = force[0], soil_force = force[1], grains = pairs_of(sums.room, rows)[0];
    }
  }
};

/// To eight faces, members of FaceSpeeds in their order.
QUICKSAND_INLINE void put_speeds(Field<FaceSpeeds>& speeds, const FaceRows& rows,
                                 const std::array<BatchLanes, 4>& v) {
  const auto first =
      transposed<4>({low_half<8>(v[0]), low_half<8>(v[1]), low_half<8>(v[2]), low_half<8>(v[3])});
  const auto second =
      transposed<4>({high_half<8>(v[0]), high_half<8>(v[1]), high_half<8>(v[2]), high_half<8>(v[3])});
  for (int k = 0; k < 4; ++k) {
    put_lanes<4>(speeds[rows.first + k].soil_old, first[k]);
    put_lanes<4>(speeds[rows.second + k].soil_old, second[k]);
  }
}
/// Their members, in that order.
QUICKSAND_INLINE std::array<BatchLanes, 4> speeds_of(const Field<FaceSpeeds>& speeds, const FaceRows& rows) {
  std::array<Lanes<4>, 4> first, second;
  for (int k = 0; k < 4; ++k) {
    first[k] = lanes_from<4>(speeds[rows.first + k].soil_old);
    second[k] = lanes_from<4>(speeds[rows.second + k].soil_old);
  }
  first = transposed<4>(first), second = transposed<4>(second);
  return {joined<4>(first[0], second[0]), joined<4>(first[1], second[1]), joined<4>(first[2], second[2]),
          joined<4>(first[3], second[3])};
}

QUICKSAND_INLINE void put_rows(Field<double>& field, const FaceRows& rows, const BatchLanes& v) {
  put_lanes<4>(field[rows.first], low_half<8>(v));
  put_lanes<4>(field[rows.second], high_half<8>(v));
}

/// viscous_acceleration, m/s².
template <int D>
QUICKSAND_INLINE BatchLanes viscous_in_lanes(const State<D>& s, int d, const FaceRows& rows,
                                             const BatchLanes& mass, const BatchLanes& v) {
  const double least = kMassCutoff * s.constants.water_density * s.volume.uniform;
  const BatchLanes none{}, one = all_lanes<BatchLanes>(1), per_mass = 1 / mass;
  BatchLanes sum{};
  for (int axis = 0; axis < D; ++axis)
    for (const int side : {-1, 1}) {
      const auto [other, momentum] = pairs_of(s.sums[d].water, rows.moved(side * s.grid.stride[axis]));
      const BatchLanes part = other * per_mass;
      const BatchLanes difference = momentum / other - v;
      sum += where(other > least, where(part < one, part, one) * difference, none);
    }
  return s.constants.viscosity / s.constants.water_density * s.grid.inverse_h * s.grid.inverse_h * sum;
}

/// predict_velocities of eight faces of grains alone.
template <class P, int D>
QUICKSAND_INLINE void predict_dry(State<D>& s, int d, const FaceRows& rows, double dt) {
  const double least = kMassCutoff * s.constants.water_density * s.volume.uniform;
  const SumsInLanes<P> sums(s.sums[d], rows);
  const BatchLanes none{}, per_mass = 1 / sums.soil_mass;
  const auto soil = sums.soil_mass > least;
  const BatchLanes old = where(soil, sums.soil_momentum * per_mass, none);
  const BatchLanes change = dt * (s.constants.fall(d) + sums.soil_force * per_mass / s.constants.inertia);
  put_speeds(s.speeds[d], rows, {old, where(soil, old + change, none), none, none});
}

/// predict_velocities of eight faces with water: [FMS19] eqs. (1) and (2) with the drag inside.
template <class P, int D>
QUICKSAND_INLINE void predict_wet(State<D>& s, int d, const FaceRows& rows, double dt) {
  const double rho = s.constants.water_density, inertia = s.constants.inertia, fall = s.constants.fall(d);
  const double per_volume = 1 / s.volume.uniform, least = kMassCutoff * rho * s.volume.uniform;
  ask_for<true>(s.flow[d], rows), ask_for<true>(s.speeds[d], rows);
  ask_for<true>(s.flux[d], rows), ask_for<true>(s.flux_response[d], rows);
  const SumsInLanes<P> sums(s.sums[d], rows);
  const BatchLanes none{}, one = all_lanes<BatchLanes>(1);
  const auto water = sums.water_mass > least;
  BatchLanes phi{};
  if constexpr (P::soil) phi = sums.grains * per_volume;
  const BatchLanes room = one - phi, least_room = all_lanes<BatchLanes>(kMinRoom);
  const BatchLanes n = where(room > least_room, room, least_room);

  const BatchLanes water_old = where(water, sums.water_momentum / sums.water_mass, none);
  BatchLanes viscous{};
  if (s.constants.viscosity > 0)
    viscous = where(water, viscous_in_lanes(s, d, rows, sums.water_mass, water_old), none);
  const BatchLanes water_mass = inertia * rho * n;
  const BatchLanes water_momentum = water_mass * (water_old + dt * (fall + viscous / inertia));

  BatchLanes soil_old{}, soil_v{}, soil_response{}, exchange{}, exchange_response{};
  BatchLanes water_v, water_response;
  if constexpr (P::soil) {
    const auto soil = sums.soil_mass > least;
    soil_old = where(soil, sums.soil_momentum / sums.soil_mass, none);
    const BatchLanes soil_mass = where(soil, inertia * per_volume * sums.soil_mass, none);
    const BatchLanes soil_momentum =
        where(soil, soil_mass * (soil_old + dt * fall) + dt * per_volume * sums.soil_force, none);
    const BatchLanes share = sums.water_mass * per_volume / (n * rho),
                     least_share = all_lanes<BatchLanes>(kLeastWetPart);
    const BatchLanes water_drag = where(soil, dt * per_volume * n * n * sums.resistivity, none) /
                                  where(share > least_share, share, least_share);
    const BatchLanes drag = share * water_drag;
    // The determinant without its products of two drags; see solve_pair.
    const BatchLanes a22 = water_mass + water_drag, determinant = soil_mass * a22 + drag * water_mass;
    const BatchLanes inverse = 1 / where(soil, determinant, water_mass), per_gradient = dt * inverse;
    const BatchLanes a11 = soil_mass + drag;
    soil_v = (a22 * soil_momentum + drag * water_momentum) * inverse;
    soil_response = (a22 * phi + drag * n) * per_gradient;
    water_v = where(soil, a11 * water_momentum + water_drag * soil_momentum, water_momentum) * inverse;
    water_response = where(soil, a11 * n + water_drag * phi, n) * per_gradient;
    soil_response = where(soil, soil_response, none);
    exchange = drag * (soil_mass * water_momentum - water_mass * soil_momentum) * inverse;
    exchange_response = drag * (soil_mass * n - water_mass * phi) * per_gradient;
  } else {
    const BatchLanes inverse = 1 / water_mass;
    water_v = water_momentum * inverse;
    water_response = dt * n * inverse;
  }

  put_speeds(s.speeds[d], rows, {soil_old, soil_v, water_old, water_v});
  const std::array<BatchLanes, 8> flow =
      transposed<8>({soil_response, water_response, phi, n, exchange, exchange_response, viscous, none});
  put_rows(s.flux[d], rows, phi * soil_v + n * water_v);
  put_rows(s.flux_response[d], rows, phi * soil_response + n * water_response);
  for (int k = 0; k < 8; ++k) {
    const int face = rows.face(k);
    put_lanes<8>(s.flow[d][face].soil_response, flow[k]);
    s.flow[d][face].wet = 1;
  }
}

template <class P, int D>
void predict_plain(State<D>& s, int block, double dt) {
  ask_for_next_sums(s, block);
  for_face_rows(
      s, block, [&](const FaceRows& rows, int d) __attribute__((always_inline)) {
        if constexpr (P::water)
          predict_wet<P>(s, d, rows, dt);
        else
          predict_dry<P>(s, d, rows, dt);
      });
}

/// The gradients between wet cells, Pa/m.
template <int D>
QUICKSAND_INLINE BatchLanes inner_gradients(const State<D>& s, const Field<double>& pressure, int d,
                                            const FaceRows& rows) {
  return (rows_of(pressure, rows) - rows_of(pressure, rows.moved(-s.grid.stride[d]))) * s.grid.inverse_h;
}
/// That which a step's velocities feel.
template <int D>
const Field<double>& felt_pressure(const State<D>& s) {
  return s.constants.explicit_pressure ? s.pressure_old : s.pressure;
}

/// correct_velocities of a block.
template <class P, int D>
void correct_plain(State<D>& s, int block) {
  if constexpr (!P::water) return;
  const Field<double>& pressure = felt_pressure(s);
  for_face_rows(
      s, block, [&](const FaceRows& rows, int d) __attribute__((always_inline)) {
        const Kept<> gradient = inner_gradients(s, pressure, d, rows);
        for (int k = 0; k < 8; ++k) {
          const int face = rows.face(k);
          const double g = gradient[k];
          FaceFlow& f = s.flow[d][face];
          FaceSpeeds& v = s.speeds[d][face];
          v.water -= f.water_response * g;
          if constexpr (P::soil) {
            v.soil -= f.soil_response * g;
            f.exchange -= f.exchange_response * g;
          }
        }
      });
}

}  // namespace quicksand

// Linear hats only. The last face that a body reaches may hold next to nothing of it, however large the
// stress of the points that reach it: the force does not vanish with the mass, and the stable step would fall
// as 2√ξ h/c with the part ξ of a full face's mass. Such a face has no acceleration of its own: all that acts
// there (forces, and with the grains their inertia, room and drag) goes to the heaviest neighbour of the same
// component, and the light face's velocity changes as that one's does. It keeps its own velocity, so that
// uniform strain and rotation pass as they are; momentum is kept exactly, and so is angular momentum but for
// the torque of a light face's force over one cell.

#include "engine/step/phases.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

/// f(neighbour) for the faces of component d next to `face` that no wall cuts off from it.
template <int D, class F>
void for_neighbours(const State<D>& s, int d, int face, F&& f) {
  for (int a = 0; a < D; ++a)
    for (int side : {0, 1}) {
      const int offset = (2 * side - 1) * s.grid.stride[a], beside = face - s.grid.stride[d];
      if (a == d) {  // across the cell between
        const int cell = side ? face : beside;
        if (!s.soil_walls.blocked(cell)) f(face + offset);
      } else {
        const int wall = side * s.grid.stride[a];
        if (!s.soil_walls.closed(a, face + wall) && !s.soil_walls.closed(a, beside + wall)) f(face + offset);
      }
    }
}

/// The heaviest neighbour, if `face` is light beside it; or 0. A closed face stays with its wall.
template <int D>
int heavy_neighbour(const State<D>& s, int d, int face) {
  if (s.soil_walls.closed(d, face)) return 0;
  int heaviest = 0;
  double mass = s.sums[d][face].soil_mass / LinearHat::light_part;
  for_neighbours(s, d, face, [&](int other) {
    if (s.sums[d][other].soil_mass > mass) mass = s.sums[d][other].soil_mass, heaviest = other;
  });
  return heaviest;
}

/// Adds what grains left on a face to another, as if they moved with it.
FaceSums joined(const FaceSums& from, FaceSums to) {
  to.soil_momentum += from.soil_mass * to.soil_momentum / to.soil_mass;
  to.soil_mass += from.soil_mass;
  to.grains += from.grains;
  to.soil_bulk += from.soil_bulk;
  to.soil_force += from.soil_force;
  to.resistivity += from.resistivity;
  return to;
}

/// Gives to `leader` what followers of `face` hold, and theirs: at a corner a light face follows one that is
/// light itself. Masses grow along the way, so that it ends.
template <int D>
void gather(State<D>& s, int d, int leader, int face) {
  for_neighbours(s, d, face, [&](int other) {
    if (s.follower[d][other].leader != face) return;
    s.sums[d].set_soil(leader, joined(s.sums[d][other], s.sums[d][leader]));
    s.image[d][leader].soil += s.image[d][other].soil;
    gather(s, d, leader, other);
  });
}

template <int D, class F>
void for_each_face(const State<D>& s, F&& f) {
  s.blocks.all([&](int b) {
    s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
      for (int d = 0; d < D; ++d) f(d, face);
    });
  });
}

}  // namespace

template <int D>
int leader_of(const State<D>& s, int d, int face) {
  while (s.follower[d][face].leader != 0) face = s.follower[d][face].leader;
  return face;
}

template <int D>
void join_light_faces(State<D>& s) {
  for_each_face<D>(s, [&](int d, int face) {
    const FaceSums sums = s.sums[d][face];
    const int leader = heavy_neighbour(s, d, face);
    const FaceSums moving = sums.soil_mass > 0 || leader == 0 ? sums : s.sums[d][leader];
    s.follower[d][face] = {leader, sums.soil_mass - s.image[d][face].soil,
                           leader == 0 ? 0 : moving.soil_momentum / moving.soil_mass};
  });
  for_each_face<D>(s, [&](int d, int face) {
    if (s.follower[d][face].leader == 0) gather(s, d, face, face);
  });
  for_each_face<D>(s, [&](int d, int face) {
    if (s.follower[d][face].leader == 0) return;
    s.sums[d].set_soil(face, {});
    s.image[d][face].soil = 0;
  });
}

template <int D>
void follow_leaders(State<D>& s) {
  for_each_face<D>(s, [&](int d, int face) {
    const Follower& f = s.follower[d][face];
    if (f.leader == 0) return;
    const FaceSpeeds& leader = s.speeds[d][leader_of(s, d, face)];
    s.speeds[d][face].soil_old = f.velocity;
    s.speeds[d][face].soil = f.velocity + leader.soil - leader.soil_old;
  });
}

template int leader_of<2>(const State<2>&, int, int);
template int leader_of<3>(const State<3>&, int, int);
template void join_light_faces<2>(State<2>&);
template void join_light_faces<3>(State<3>&);
template void follow_leaders<2>(State<2>&);
template void follow_leaders<3>(State<3>&);

}  // namespace quicksand

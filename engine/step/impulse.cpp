// What walls do to the momentum of the points, for the ledger.
//
// A face hands Δv to the points with the mass M (× inertia) that they left on it, so they gain Σ M Δv, less
// what goes to mirror images. Drag between the phases cancels face by face; weight is counted elsewhere. What
// is left are the reactions of supports: of the effective stress (its forces sum to zero but for walls), of
// the pressure (over all material, ∫∇p dV is the pressure on its walls, as p = 0 on the free surface), of
// fixed grains, of contact, of the mirrors, and the shear of the water on no-slip walls.

#include "engine/step/phases.hpp"
#include "engine/step/plain_faces.hpp"
#include "engine/step/scheme.hpp"

namespace quicksand {
namespace {

template <class P, int D>
double soil_reaction(const State<D>& s, int d, int face, double dt) {
  const FaceSums sums = s.sums[d][face];
  const FaceSpeeds& v = s.speeds[d][face];
  if (sums.soil_mass <= kMassCutoff * s.constants.water_density * s.volume.face(d, face)) return 0;
  const double change = v.soil - v.soil_old;
  const double mirrored = -s.constants.inertia * s.image[d][face].soil * change;
  const bool stopped = s.soil_walls.closed(d, face) && v.soil == 0;
  if (stopped || in_plate(s, d, face)) {
    const double drag = P::water ? s.flow[d][face].exchange * s.volume.face(d, face) : 0;
    return mirrored + s.constants.inertia * sums.soil_mass * (change - dt * s.constants.fall(d)) - drag;
  }
  if constexpr (!P::water) return mirrored + dt * sums.soil_force;
  const FaceFlow& f = s.flow[d][face];
  double gradient = gradient_on_grains(s, d, face);
  if (s.fixed.size() && f.phi > 0)
    gradient += (s.rest[d][face].pushed / f.phi - 1) *
                (gradient - s.constants.water_density * s.constants.gravity[d]);
  return mirrored + dt * (sums.soil_force - sums.grains * gradient);
}

template <int D>
double water_reaction(const State<D>& s, int d, int face, double dt) {
  const FaceSums sums = s.sums[d][face];
  const FaceFlow& f = s.flow[d][face];
  const FaceSpeeds& v = s.speeds[d][face];
  if (s.water_walls.closed(d, face)) return -dt * sums.water_mass * s.constants.gravity[d];
  const double mirrored = -s.constants.inertia * s.image[d][face].water * (v.water - v.water_old);
  if (in_plate(s, d, face))
    return mirrored +
           s.constants.inertia * sums.water_mass * (v.water - v.water_old - dt * s.constants.fall(d));
  if (f.wet > 1) return mirrored;  // carried along by the surface
  const double rho = s.constants.water_density, pressure = f.wet ? felt_gradient(s, d, face) : 0;
  const double fixed = s.fixed.size() ? s.rest[d][face].fixed_drag * v.water / f.n : 0;
  return mirrored + dt * sums.water_mass * (f.viscous - (pressure + fixed) / rho);
}

/// Drops above the last wet face move with the water below them instead of falling through it.
template <int D>
double surface_support(const State<D>& s, int d, int face, double dt) {
  const FaceSums sums = s.sums[d][face];
  const FaceFlow& f = s.flow[d][face];
  const FaceSpeeds& v = s.speeds[d][face];
  if (f.wet < 2) return 0;
  return s.constants.inertia * sums.water_mass * (v.water - v.water_old - dt * s.constants.fall(d)) +
         f.exchange * s.volume.face(d, face);
}

template <int D>
struct Damped {
  Vec<D> impulse{};
  double energy = 0;
};
/// Of a phase that damping gave the inertia μ M: its forces alone would have changed v by μ Δv.
template <int D>
void add_damping(int d, double mass, double inertia, double before, double after, Damped<D>& sum) {
  const double impulse = (1 - inertia) * mass * (after - before);
  sum.impulse[d] += impulse;
  const double alone = before + inertia * (after - before);
  sum.energy -= 0.5 * impulse * (alone + after);
}
template <int D>
void add_damping(const State<D>& s, int d, int face, Damped<D>& sum) {
  const FaceSums sums = s.sums[d][face];
  const FaceFlow& f = s.flow[d][face];
  const FaceSpeeds& v = s.speeds[d][face];
  const FaceRest& rest = s.rest[d][face];
  const bool stopped = s.soil_walls.closed(d, face) && v.soil == 0;
  if (!stopped)
    add_damping(d, s.constants.inertia * sums.soil_mass, rest.soil_inertia, v.soil_old, v.soil, sum);
  if (f.wet < 2)
    add_damping(d, s.constants.inertia * sums.water_mass, rest.water_inertia, v.water_old, v.water, sum);
}

/// The leader's sums hold a follower's mass as if it had the leader's old velocity.
template <int D>
double momentum_beside_leader(const State<D>& s, int d, int face) {
  const Follower& f = s.follower[d][face];
  return f.leader == 0 ? 0 : f.mass * (f.velocity - s.speeds[d][leader_of(s, d, face)].soil_old);
}

template <int D>
struct Sum {
  Vec<D> reaction{}, surface{}, grid{};  ///< grid: Σ M v of the old grid velocities
  Damped<D> damped;
  Sum& operator+=(const Sum& o) {
    for (int d = 0; d < D; ++d) {
      reaction[d] += o.reaction[d], surface[d] += o.surface[d], grid[d] += o.grid[d];
      damped.impulse[d] += o.damped.impulse[d];
    }
    damped.energy += o.damped.energy;
    return *this;
  }
};

template <class P, int D>
void add_face(const State<D>& s, int d, int face, double dt, Sum<D>& sum) {
  if (s.constants.kernel == Kernel::linear) sum.grid[d] += momentum_beside_leader(s, d, face);
  const FaceSums sums = s.sums[d][face];
  if (sums.soil_mass == 0 && sums.water_mass == 0) return;
  if constexpr (P::soil) sum.reaction[d] += soil_reaction<P>(s, d, face, dt);
  if constexpr (P::water) {
    sum.reaction[d] += water_reaction(s, d, face, dt);
    sum.surface[d] += surface_support(s, d, face, dt);
  }
  if (s.constants.damping > 0) add_damping(s, d, face, sum.damped);
  const FaceSpeeds& v = s.speeds[d][face];
  const FaceImage& image = s.image[d][face];
  sum.grid[d] += (sums.soil_mass - image.soil) * v.soil_old + (sums.water_mass - image.water) * v.water_old;
}

/// The same for a plain block: what the pressure does, and the stress, where there is nothing else.
template <class P, int D>
void add_plain(const State<D>& s, int block, double dt, Sum<D>& sum) {
  const Field<double>& pressure = felt_pressure(s);
  const double rho = s.constants.water_density, per_density = 1 / rho;
  const double least = kMassCutoff * rho * s.volume.uniform;
  std::array<BatchLanes, D> reaction{}, grid{};
  ask_for_next_sums(s, block);
  for_face_rows(
      s, block, [&](const FaceRows& rows, int d) __attribute__((always_inline)) {
        const SumsInLanes<P> sums(s.sums[d], rows);
        const auto [soil_old, soil, water_old, water] = speeds_of(s.speeds[d], rows);
        BatchLanes g{};
        if constexpr (P::water) g = inner_gradients(s, pressure, d, rows);
        if constexpr (P::soil) {
          BatchLanes force = sums.soil_force;
          if constexpr (P::water) force -= sums.grains * g;
          reaction[d] += where(sums.soil_mass > least, force, BatchLanes{});
          grid[d] += sums.soil_mass * soil_old;
        }
        if constexpr (P::water) {
          const BatchLanes viscous = lanes_of<kBatch>([&](int k) { return s.flow[d][rows.face(k)].viscous; });
          reaction[d] += sums.water_mass * (viscous - g * per_density);
          grid[d] += sums.water_mass * water_old;
        }
      });
  for (int d = 0; d < D; ++d)
    for (int k = 0; k < kBatch; ++k) sum.reaction[d] += dt * reaction[d][k], sum.grid[d] += grid[d][k];
}

}  // namespace

template <int D>
Supports<D> support_impulses(const State<D>& s, double dt, double pic) {
  Sum<D> sum = with_phases(s, [&](auto phases) {
    return s.blocks.template sum<Sum<D>>([&](int b) {
      Sum<D> part;
      if (s.plain[b] && s.constants.kernel != Kernel::linear) {
        add_plain<decltype(phases)>(s, b, dt, part);
        return part;
      }
      s.blocks.cells(s.grid, b, true, [&](int face, const Cell<D>&) {
        for (int d = 0; d < D; ++d) add_face<decltype(phases)>(s, d, face, dt, part);
      });
      return part;
    });
  });
  for (const Plate<D>& plate : s.plates)
    for (int d = 0; d < D; ++d) sum.grid[d] += plate.slid[d];
  // Relaxing points to the grid's velocity keeps momentum but for what mirrors took from the grid.
  Supports<D> impulse;
  for (int d = 0; d < D; ++d) {
    impulse.walls[d] =
        sum.reaction[d] - dt * s.load_force[d] + pic * (s.constants.inertia * sum.grid[d] - s.momentum[d]);
    impulse.surface[d] = sum.surface[d];
  }
  for (const Plate<D>& plate : s.plates)  // images have inertia and weight, but are no mass
    if (plate.folded) impulse.walls[kPlateAxis] += dt * s.constants.gravity[kPlateAxis] * plate.mirrored;
  impulse.damping = sum.damped.impulse;
  impulse.damped = sum.damped.energy;
  return impulse;
}

template Supports<2> support_impulses<2>(const State<2>&, double, double);
template Supports<3> support_impulses<3>(const State<3>&, double, double);

}  // namespace quicksand

#pragma once
#include <array>
#include <vector>

#include "engine/materials/soil_material.hpp"

namespace quicksand {

/// Saturated soil as the stability analysis sees it.
struct SaturatedSoil {
  double constrained_modulus = 0;  ///< Pa, Ec
  double grain_density = 2650;     ///< kg/m³
  double water_density = 1000;     ///< kg/m³
  double water_compliance = 0;     ///< 1/Pa; 0: incompressible
  double porosity = 0.4;           ///< –
  double drag = 0;                 ///< N·s/m⁴, R
  double shear_modulus = 0;        ///< Pa, G
};

/// Largest stable step (s) of dry grains in cells of h metres: the shortest wave of the staggered lattice,
/// h/√(Ec/((1−n)ρs)).
double dry_step_limit(const SaturatedSoil& soil, double h);

/// Largest stable step (s) with drag and pressure implicit and the stress explicit: von Neumann analysis of
/// the scheme of step.cpp for plane waves on the lattice, bisected on the spectral radius.
double coupled_step_limit(const SaturatedSoil& soil, double h);

/// Largest stable step (s) of grains next to free water, where the water need not give way: the frame's wave
/// damped by drag alone, (2Δt/h)² Ec/Ms ≤ 4 + 2 Δt R/Ms. Smaller than coupled_step_limit in permeable soil,
/// and some grain is always next to free water.
double surface_step_limit(const SaturatedSoil& soil, double h);

/// Largest stable step (s) of shear waves, which neither pressure nor drag hinders as grains and water swing
/// together: h/√(G/Ms), on the safe side by the water's inertia. The bound in tight soil.
double shear_step_limit(const SaturatedSoil& soil, double h);

/// Largest stable step (s) along one axis with the pressure explicit and the drag implicit: h/c of the fast
/// wave without drag, which is at least as fast as the undrained one. Requires compressible water. A lattice
/// of D dimensions passes waves with √D times the wave number, so that its bound is smaller by √D.
double fast_wave_step_limit(const SaturatedSoil& soil, double h);

/// Edge (m) of the cells by which waves are bounded, in cells of h metres: h, or what the lightest faces of
/// linear hats leave of it; half of it with one point per cell and axis.
double bounding_edge(Kernel kernel, double h, int points_per_cell);

/// The bounds tabulated over porosity, for one soil; cheap enough to ask for every point. Soil whose
/// stiffness varies has a table for every factor of four in stiffness.
class StepLimit {
 public:
  StepLimit() = default;
  /// `inertia`: what the densities of grains and water are multiplied by.
  StepLimit(const SoilMaterial& soil, double water_density, double water_compliance, double h,
            double inertia = 1);
  /// `modulus` is the point's elastic constrained modulus, Pa.
  double dry(double porosity, double modulus) const { return look_up(&Bounds::dry, porosity, modulus); }
  /// The smallest of coupled_step_limit, surface_step_limit and shear_step_limit.
  double saturated(double porosity, double modulus) const {
    return look_up(&Bounds::saturated, porosity, modulus);
  }
  /// fast_wave_step_limit; infinite in incompressible water.
  double fast_wave(double porosity, double modulus) const {
    return look_up(&Bounds::fast_wave, porosity, modulus);
  }

  /// Some porosities, from the smallest to the largest; none while low > high.
  struct Range {
    double low = 2, high = -1;
  };
  /// The smallest bound of soil whose stiffness does not vary, with porosities of a range: of all that lie in
  /// it. Infinite if there are none.
  double least_dry(const Range& n) const { return least(&Bounds::dry, n); }
  double least_saturated(const Range& n) const { return least(&Bounds::saturated, n); }
  double least_fast_wave(const Range& n) const { return least(&Bounds::fast_wave, n); }

 private:
  static constexpr int kEntries = 50;
  using Table = std::array<double, kEntries>;
  struct Bounds {
    Table dry{}, saturated{}, fast_wave{};
  };
  double look_up(Table Bounds::*table, double porosity, double modulus) const;
  double least(Table Bounds::*table, const Range& n) const;
  std::vector<Bounds> bounds_;  ///< one, or one per stiffness
  double softest_ = 0;          ///< Pa, stiffness of the first
};

}  // namespace quicksand

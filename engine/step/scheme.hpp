#pragma once
// The choices of a run that every point's loop depends on, as types: a pass is compiled for each, so that no
// point asks.

#include "engine/grid/stencil.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// A kernel, whether points carry a gradient of their velocity (transfer apic), and whether the plane turns
/// about an axis.
template <class S, bool with_gradient, bool about_axis>
struct Scheme {
  using Shape = S;
  static constexpr bool affine = with_gradient, axial = about_axis;
};

/// f(Scheme) with the run's kernel, transfer and dimension.
template <int D, class F>
auto with_scheme(const State<D>& s, F&& f) {
  const bool apic = s.constants.transfer == Transfer::apic;
  return with_kernel(s.constants.kernel, [&](auto shape) {
    return with_axial(s.grid, [&](auto axial) {
      using Shape = decltype(shape);
      return apic ? f(Scheme<Shape, true, axial>{}) : f(Scheme<Shape, false, axial>{});
    });
  });
}

/// What a scene holds.
template <bool with_soil, bool with_water>
struct Phases {
  static constexpr bool soil = with_soil, water = with_water;
};
/// f(Phases): a dry scene, or one of water alone, runs what only it needs.
template <int D, class F>
decltype(auto) with_phases(const State<D>& s, F&& f) {
  if (!s.has_water) return f(Phases<true, false>{});
  return s.has_soil ? f(Phases<true, true>{}) : f(Phases<false, true>{});
}

}  // namespace quicksand

#include "engine/plan/expected_error.hpp"

#include <algorithm>
#include <cmath>

#include "engine/scene/region.hpp"
#include "engine/scene/stages.hpp"

namespace quicksand {
namespace {

/// Largest errors measured, rounded up, on cells twice, once and half the standard ones: draft, standard,
/// fine.
struct Measured {
  double twice, once, half;
};
constexpr Measured kSmooth{0.025, 0.016, 0.008};  // unloading 0.0224, waves 0.0151, sheet pile 0.0055
constexpr Measured kRough{0.065, 0.035, 0.02};    // settling 0.0619 and 0.0335, Prandtl 0.0154

/// Cells along the largest body of the coarsest verification cases (Mandel, Terzaghi, unloading).
constexpr double kFewestCells = 10;

double at_factor(const Measured& e, double factor) {
  // Between the presets a power of the cells; beyond them first order, the lowest that was seen.
  if (factor >= 2) return e.twice * factor / 2;
  if (factor <= 0.5) return e.half * factor / 0.5;
  const auto [coarse, fine] = factor > 1 ? std::pair{e.twice, e.once} : std::pair{e.once, e.half};
  const double order = std::log2(coarse / fine);
  return e.once * std::pow(factor, order);
}

double largest_extent(const Scene& scene) {
  double extent = 0;
  const std::size_t axes = scene.domain.dimension == Dimension::space ? 3 : 2;
  for (const Body& body : scene.bodies) {
    const Bounds box = bounding_box(body.region);
    for (std::size_t d = 0; d < axes; ++d) extent = std::max(extent, box.max[d] - box.min[d]);
  }
  return extent;
}

}  // namespace

const char* word_of(ErrorClass kind) {
  switch (kind) {
    case ErrorClass::yielding:
      return "yielding";
    case ErrorClass::free_water:
      return "free_water";
    case ErrorClass::smooth:
      break;
  }
  return "smooth";
}

ErrorClass error_class(const Scene& scene) {
  for (const Body& body : scene.bodies)
    if (body.kind != BodyKind::water && !body.fixed &&
        scene.soils.at(body.soil).model.law != SoilLaw::linear_elastic)
      return ErrorClass::yielding;
  const bool free = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                [](const Body& body) { return body.kind == BodyKind::water; });
  const auto& sides = scene.domain.sides;
  const bool opened = !scene.gates.empty() || std::any_of(sides.begin(), sides.end(), [](const Side& side) {
    return side.kind == SideKind::open;
  });
  return free && (opened || !has_soil(scene)) ? ErrorClass::free_water : ErrorClass::smooth;
}

double expected_error(const Scene& scene) {
  const Measured& measured = error_class(scene) == ErrorClass::smooth ? kSmooth : kRough;
  const double cells = largest_extent(scene) / scene.cell_size();
  const double resolved = at_factor(measured, scene.numerics.cell_size_factor);
  return resolved * std::max(1.0, kFewestCells / cells);
}

}  // namespace quicksand

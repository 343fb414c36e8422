#include "engine/plan/companions.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "engine/scene/check.hpp"
#include "engine/scene/check_parts.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

/// Whether points, which fill whole parts of a cell, can end at this coordinate.
bool points_end_at(const Scene& scene, std::size_t axis, double x) {
  const double parts =
      (x - scene.domain.min[axis]) / scene.cell_size() * static_cast<double>(scene.numerics.points_per_cell);
  return std::abs(parts - std::round(parts)) < 1e-6;
}

/// Whether bodies reach as far on the other cells as they do on the scene's own. Where they do not, the runs
/// differ by what was put in (a level by part of a cell) and not by how it was computed.
bool holds_the_same_bodies(const Scene& scene, const Scene& other) {
  for (const Body& body : scene.bodies)
    for (std::size_t axis = 0; axis < axes(scene); ++axis)
      for (const double x : square_sides(body.region, axis))
        if (points_end_at(scene, axis, x) && !points_end_at(other, axis, x)) return false;
  return true;
}

/// The first of the ratios with cells on which the scene can be run. Ratios nearer to 1 than 5/4 would divide
/// the noise of a run by a small number; far ones leave the range in which errors follow a power of the
/// cells.
std::optional<Companion> on_other_cells(const Scene& scene, std::initializer_list<double> ratios) {
  Companion companion{scene, 1};
  companion.scene.numerics.error_estimate = ErrorEstimate::none;
  double end = 0;
  for (const Stage& stage : scene.stages) end += stage.duration;
  companion.scene.output.frame_interval = std::max(end, scene.output.frame_interval);
  for (const double ratio : ratios) {
    companion.ratio = ratio;
    companion.scene.numerics.cell_size_factor = scene.numerics.cell_size_factor * ratio;
    if (check(companion.scene).empty() && holds_the_same_bodies(scene, companion.scene)) return companion;
  }
  return {};
}

}  // namespace

Companions companions(const Scene& scene) {
  Companions found;
  if (scene.numerics.error_estimate == ErrorEstimate::none) return found;
  found.coarser = on_other_cells(scene, {2, 1.5, 4.0 / 3, 1.25, 3});
  if (scene.numerics.error_estimate == ErrorEstimate::finer)
    found.finer = on_other_cells(scene, {0.5, 2.0 / 3, 0.75, 0.8, 1.0 / 3});
  return found;
}

std::optional<Fault> no_companion(const Scene& scene) {
  const Companions found = companions(scene);
  if (scene.numerics.error_estimate == ErrorEstimate::none || found.finer) return {};
  const bool finer = scene.numerics.error_estimate == ErrorEstimate::finer;
  if (!finer && found.coarser) return {};
  return Fault{"/numerics/error_estimate",
               finer ? "no finer cells fit the walls, the sides and the ends of the bodies: give true, or "
                       "another domain.cell_size"
                     : "no coarser cells fit the walls, the sides and the ends of the bodies: give "
                       "\"finer\", or a smaller domain.cell_size"};
}

}  // namespace quicksand

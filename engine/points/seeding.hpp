#pragma once
#include "engine/points/points.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

template <int D>
struct SeededPoints {
  SoilPoints<D> soil;   ///< moving grains
  SoilPoints<D> fixed;  ///< grains of bodies held in place
  WaterPoints<D> water;
};

struct PointCounts {
  std::size_t soil = 0, fixed = 0, water = 0;
  std::size_t active_cells = 0;  ///< of the blocks that are active around moving points
};
/// How many points `seed` would make, and where, without making them.
template <int D>
PointCounts count_points(const Scene& scene, const Grid<D>& grid);

/// Points of all bodies on a regular lattice, `points_per_cell` along each axis, each with the mass of its
/// share of the cell (about an axis times its radius). Saturated soil gets a soil and a water point at each
/// place. `SoilPoints::soil` is the place of the material in Scene::soils.
template <int D>
SeededPoints<D> seed(const Scene& scene, const Grid<D>& grid);

}  // namespace quicksand

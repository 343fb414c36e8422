#pragma once
// Bodies point by point: what the points that would be seeded lie in. Point (i, j) of a grid of
// points_per_cell per cell and axis lies at domain.min + ((i, j) + ½) cell_size / points_per_cell.

#include <map>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// Layers of points that cut the regions alike; the plane is one layer.
struct Slab {
  long from = 0, to = 1;  ///< half-open range of layers
  double depth = 0;       ///< m, z of the first layer
};

/// All slabs of the scene, front to back.
std::vector<Slab> slabs_of(const Scene& scene);

/// Points that lie in two things at once.
struct Overlap {
  long points = 0;
  Vec3 place{};  ///< of the first
};

/// What the rows say about all bodies.
struct Survey {
  std::vector<long> points;        ///< per body
  std::vector<Overlap> in_blocks;  ///< per body
  std::vector<bool> cuts_cells;    ///< per body: some cell is only partly covered
  std::map<std::pair<std::size_t, std::size_t>, Overlap> overlaps;  ///< first body, later body
};

Survey survey_bodies(const Scene& scene, const std::vector<Slab>& slabs);

}  // namespace quicksand

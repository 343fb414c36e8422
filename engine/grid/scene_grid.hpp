#pragma once
// Lattice, walls and gates of a scene.

#include <string>
#include <utility>
#include <vector>

#include "engine/grid/walls.hpp"
#include "engine/scene/scene.hpp"

namespace quicksand {

template <int D>
Grid<D> make_grid(const Scene& scene);

/// A face of the boundary through which points enter and leave.
struct PortFace {
  int d = 0, face = 0;
  int inward = 1;      ///< +1 or −1 along d
  int reservoir = -1;  ///< index into Scene::reservoirs; −1: an open side
};

template <int D>
struct SceneWalls {
  Walls<D> water;  ///< blocks, thin walls, closed gates, domain sides; ports at reservoirs and open sides
  Walls<D> soil;   ///< the same without the reservoirs' ports, and the outside of fixed soil bodies
  std::vector<PortFace> ports;
};
/// All gates but `open_gates` are closed; bodies that `removed` marks (empty: none) are not there.
template <int D>
SceneWalls<D> make_walls(const Scene& scene, const Grid<D>& grid, const std::vector<std::string>& open_gates,
                         const std::vector<char>& removed = {});

/// (component, face) of every face on a segment.
template <int D>
std::vector<std::pair<int, int>> faces_on(const Grid<D>& grid, const Segment& line);

}  // namespace quicksand

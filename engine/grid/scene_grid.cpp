#include "engine/grid/scene_grid.hpp"

#include <algorithm>
#include <cmath>

#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

template <int D>
Vec3 to_vec3(const Vec<D>& x) {
  Vec3 v{};
  for (int d = 0; d < D; ++d) v[d] = x[d];
  return v;
}

/// Closes every face between cells marked inside and cells marked outside.
template <int D>
void close_outline(const Grid<D>& grid, const std::vector<char>& inside, Walls<D>& walls, bool no_slip) {
  for_each_cell(grid, [&](int i, const Cell<D>&) {
    for (int d = 0; d < D; ++d)
      for (int side : {0, 1}) {
        const int other = i + (2 * side - 1) * grid.stride[d];
        if (inside[i] && !inside[other]) walls.close(d, i + side * grid.stride[d], no_slip);
      }
  });
}

template <int D>
std::vector<char> cells_in(const Grid<D>& grid, const Region& region) {
  std::vector<char> inside(grid.count(), 0);
  for_each_cell(
      grid, [&](int i, const Cell<D>& c) { inside[i] = contains(region, to_vec3<D>(grid.center(c)), D); });
  return inside;
}

template <int D>
void close_domain(const Scene& scene, const Grid<D>& grid, Walls<D>& walls) {
  const auto close = [&](int d, int face, SideKind kind) {
    if (kind == SideKind::symmetry)
      walls.close_as_symmetry(d, face);
    else
      walls.close(d, face, kind == SideKind::no_slip);
  };
  const auto on_axis = [&](int d) { return grid.axial && d == 0 && grid.origin[0] == 0; };
  for_each_cell(grid, [&](int i, const Cell<D>& c) {
    for (int d = 0; d < D; ++d) {
      if (c[d] == 0) close(d, i, on_axis(d) ? SideKind::symmetry : scene.domain.sides[2 * d].kind);
      if (c[d] == grid.cells[d] - 1) close(d, i + grid.stride[d], scene.domain.sides[2 * d + 1].kind);
    }
  });
}

/// Faces of reservoirs and of open sides that have room on exactly one side.
template <int D>
std::vector<PortFace> find_ports(const Scene& scene, const Grid<D>& grid, const Walls<D>& walls) {
  std::vector<PortFace> ports;
  const auto add = [&](int d, int face, int reservoir) {
    const bool low = walls.blocked(face - grid.stride[d]), high = walls.blocked(face);
    if (low != high) ports.push_back({d, face, low ? 1 : -1, reservoir});
  };
  for (std::size_t r = 0; r < scene.reservoirs.size(); ++r)
    for (const auto& [d, face] : faces_on(grid, scene.reservoirs[r].line)) add(d, face, static_cast<int>(r));
  const std::size_t of_reservoirs = ports.size();
  const auto taken = [&](int d, int face) {
    for (std::size_t k = 0; k < of_reservoirs; ++k)
      if (ports[k].d == d && ports[k].face == face) return true;
    return false;
  };
  for_each_cell(grid, [&](int i, const Cell<D>& c) {
    for (int d = 0; d < D; ++d)
      for (int side : {0, 1}) {
        const int face = i + side * grid.stride[d];
        if (c[d] != (side ? grid.cells[d] - 1 : 0)) continue;
        if (scene.domain.sides[2 * d + side].kind == SideKind::open && !taken(d, face)) add(d, face, -1);
      }
  });
  return ports;
}

}  // namespace

template <int D>
Grid<D> make_grid(const Scene& scene) {
  const double h = scene.cell_size();
  Vec<D> low;
  Cell<D> count;
  for (int d = 0; d < D; ++d) {
    low[d] = scene.domain.min[d];
    count[d] = static_cast<int>(std::lround((scene.domain.max[d] - scene.domain.min[d]) / h));
  }
  Grid<D> grid(low, count, h);
  grid.axial = scene.domain.dimension == Dimension::axisymmetric;
  return grid;
}

template <int D>
std::vector<std::pair<int, int>> faces_on(const Grid<D>& grid, const Segment& line) {
  std::array<int, D> low, high;
  int normal = -1;
  for (int d = 0; d < D; ++d) {
    const double a = std::min(line.from[d], line.to[d]), b = std::max(line.from[d], line.to[d]);
    low[d] = static_cast<int>(std::lround((a - grid.origin[d]) * grid.inverse_h));
    high[d] = static_cast<int>(std::lround((b - grid.origin[d]) * grid.inverse_h));
    if (low[d] == high[d]) normal = d;
  }
  std::vector<std::pair<int, int>> faces;
  if (normal < 0) return faces;
  high[normal] = low[normal] + 1;
  for (int d = 0; d < D; ++d) {
    low[d] = std::max(low[d], 0);
    high[d] = std::min(high[d], grid.cells[d] + (d == normal));
    if (low[d] >= high[d]) return faces;
  }
  Cell<D> c = low;
  while (true) {
    faces.emplace_back(normal, grid.index(c));
    int d = 0;
    for (; d < D && ++c[d] == high[d]; ++d) c[d] = low[d];
    if (d == D) return faces;
  }
}

template <int D>
SceneWalls<D> make_walls(const Scene& scene, const Grid<D>& grid, const std::vector<std::string>& open_gates,
                         const std::vector<char>& removed) {
  Walls<D> walls(grid);
  close_domain(scene, grid, walls);
  for (const Wall& wall : scene.walls) {
    if (wall.block) {
      const auto inside = cells_in(grid, *wall.block);
      close_outline(grid, inside, walls, wall.no_slip);
      for (int i = 0; i < grid.count(); ++i)
        if (inside[i]) walls.block(i);
    }
    if (wall.line)
      for (const auto& [d, face] : faces_on(grid, *wall.line)) walls.close(d, face, wall.no_slip);
  }
  for (const Gate& gate : scene.gates) {
    if (std::find(open_gates.begin(), open_gates.end(), gate.name) != open_gates.end()) continue;
    for (const auto& [d, face] : faces_on(grid, gate.line)) walls.close(d, face, false);
  }
  SceneWalls<D> both{walls, walls, find_ports(scene, grid, walls)};
  for (const PortFace& port : both.ports) {
    both.water.make_port(port.d, port.face);
    if (port.reservoir < 0) both.soil.make_port(port.d, port.face);
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (!body.fixed || (!removed.empty() && removed[b])) continue;
    const auto inside = cells_in(grid, body.region);
    close_outline(grid, inside, both.soil, false);
    for (int i = 0; i < grid.count(); ++i)
      if (inside[i]) both.soil.block(i);
  }
  both.water.rebuild(grid);
  both.soil.rebuild(grid);
  return both;
}

template Grid<2> make_grid<2>(const Scene&);
template Grid<3> make_grid<3>(const Scene&);
template std::vector<std::pair<int, int>> faces_on<2>(const Grid<2>&, const Segment&);
template std::vector<std::pair<int, int>> faces_on<3>(const Grid<3>&, const Segment&);
template SceneWalls<2> make_walls<2>(const Scene&, const Grid<2>&, const std::vector<std::string>&,
                                     const std::vector<char>&);
template SceneWalls<3> make_walls<3>(const Scene&, const Grid<3>&, const std::vector<std::string>&,
                                     const std::vector<char>&);

}  // namespace quicksand

// The grid, and the walls, gates and other lines that must lie on its faces.

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/scene/check_parts.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

/// Coordinates within this share of a cell of a face lie on it: far above rounding, far below what matters.
constexpr double face_tolerance = 1e-6;
/// A limit against slips of the pen; memory is the plan's concern.
constexpr double max_cells = 50e6;

/// Distance from the domain's lower corner in cells.
double in_cells(const Scene& scene, std::size_t axis, double coordinate) {
  return (coordinate - scene.domain.min[axis]) / scene.cell_size();
}

bool whole(double cells) { return std::abs(cells - std::round(cells)) <= face_tolerance; }

bool on_corner(const Scene& scene, const Vec3& point) {
  return whole(in_cells(scene, 0, point[0])) && whole(in_cells(scene, 1, point[1]));
}

Vec3 nearest_corner(const Scene& scene, const Vec3& point) {
  Vec3 corner{};
  for (std::size_t axis = 0; axis < 2; ++axis)
    corner[axis] =
        scene.domain.min[axis] + std::round(in_cells(scene, axis, point[axis])) * scene.cell_size();
  return corner;
}

bool in_domain(const Scene& scene, const Vec3& point) {
  const double slack = face_tolerance * scene.cell_size();
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (point[axis] < scene.domain.min[axis] - slack || point[axis] > scene.domain.max[axis] + slack)
      return false;
  return true;
}

std::string outside_words(const Scene& scene, const Vec3& point) {
  return text(point) + " is outside the domain " + text(scene.domain.min) + " to " + text(scene.domain.max);
}

bool check_corner(const Scene& scene, const Vec3& point, const std::string& pointer, Faults& faults) {
  if (!in_domain(scene, point))
    faults.push_back({pointer, outside_words(scene, point)});
  else if (!on_corner(scene, point))
    faults.push_back({pointer, text(point) + " is not on a corner of " + cell_words(scene) +
                                   ": the nearest is " + text(nearest_corner(scene, point))});
  else
    return true;
  return false;
}

/// A line in whole cells: `fixed` along the axis that does not change.
struct GridLine {
  std::size_t axis = 0;  ///< along which it runs
  long fixed = 0, from = 0, to = 0;
  bool on_edge = false;  ///< of the domain
};

/// The line on the grid, or faults.
std::optional<GridLine> check_line(const Scene& scene, const Segment& line, const std::string& pointer,
                                   Faults& faults) {
  const double slack = face_tolerance * scene.cell_size();
  const bool along_x = std::abs(line.to[0] - line.from[0]) > slack,
             along_y = std::abs(line.to[1] - line.from[1]) > slack;
  if (!along_x && !along_y) faults.push_back({pointer, "has no length"});
  if (along_x && along_y)
    faults.push_back({pointer, "from " + text(line.from) + " to " + text(line.to) +
                                   " does not run along a grid axis: make x or y equal"});
  const bool from = check_corner(scene, line.from, pointer + "/from", faults);
  const bool to = check_corner(scene, line.to, pointer + "/to", faults);
  if (along_x == along_y || !from || !to) return std::nullopt;
  GridLine g;
  g.axis = along_x ? 0 : 1;
  g.fixed = std::lround(in_cells(scene, 1 - g.axis, line.from[1 - g.axis]));
  g.from = std::lround(in_cells(scene, g.axis, line.from[g.axis]));
  g.to = std::lround(in_cells(scene, g.axis, line.to[g.axis]));
  if (g.from > g.to) std::swap(g.from, g.to);
  g.on_edge = g.fixed == 0 || g.fixed == cells_along(scene, 1 - g.axis);
  return g;
}

bool overlap(const GridLine& a, const GridLine& b) {
  return a.axis == b.axis && a.fixed == b.fixed && std::max(a.from, b.from) < std::min(a.to, b.to);
}

/// True when the block makes the whole line part of a solid or of its surface.
bool covers(const Scene& scene, const Region& block, const GridLine& line) {
  const auto low = [&](std::size_t axis) { return std::lround(in_cells(scene, axis, block.min[axis])); };
  const auto high = [&](std::size_t axis) { return std::lround(in_cells(scene, axis, block.max[axis])); };
  const std::size_t other = 1 - line.axis;
  return low(line.axis) <= line.from && line.to <= high(line.axis) && low(other) <= line.fixed &&
         line.fixed <= high(other);
}

void check_block(const Scene& scene, const Region& block, const std::string& pointer, Faults& faults) {
  if (block.kind != Region::Kind::box)
    return faults.push_back({pointer, "a block must be a box: use several walls for other shapes"});
  if (!(block.min[0] < block.max[0] && block.min[1] < block.max[1]))
    faults.push_back({pointer + "/box", "from " + text(block.min) + " to " + text(block.max) +
                                            " is empty: max must exceed min"});
  check_corner(scene, block.min, pointer + "/box/min", faults);
  check_corner(scene, block.max, pointer + "/box/max", faults);
}

std::vector<std::optional<GridLine>> check_walls(const Scene& scene, Faults& faults) {
  std::vector<std::optional<GridLine>> lines(scene.walls.size());
  for (std::size_t k = 0; k < scene.walls.size(); ++k) {
    const Wall& wall = scene.walls[k];
    if (wall.block.has_value() == wall.line.has_value())
      faults.push_back({at_index("walls", k), "give exactly one of block and line"});
    if (wall.block) check_block(scene, *wall.block, at_index("walls", k, "/block"), faults);
    if (!wall.line) continue;
    lines[k] = check_line(scene, *wall.line, at_index("walls", k, "/line"), faults);
    if (lines[k] && lines[k]->on_edge)
      faults.push_back(
          {at_index("walls", k, "/line"), "lies on the domain's edge and has no effect: set domain.sides"});
  }
  return lines;
}

void check_gates(const Scene& scene, const std::vector<std::optional<GridLine>>& walls, Faults& faults) {
  std::vector<std::optional<GridLine>> gates(scene.gates.size());
  for (std::size_t k = 0; k < scene.gates.size(); ++k) {
    const std::string pointer = at_index("gates", k, "/line");
    gates[k] = check_line(scene, scene.gates[k].line, pointer, faults);
    if (!gates[k]) continue;
    const GridLine& gate = *gates[k];
    if (gate.on_edge)
      faults.push_back({pointer, "lies on the domain's edge: behind it there is nothing to open to"});
    for (std::size_t j = 0; j < k; ++j)
      if (gates[j] && overlap(gate, *gates[j]))
        faults.push_back(
            {pointer, "lies on the gate \"" + scene.gates[j].name + "\": each piece can have one gate"});
    for (std::size_t j = 0; j < walls.size(); ++j) {
      const Wall& wall = scene.walls[j];
      if (walls[j] && overlap(gate, *walls[j]))
        faults.push_back({pointer, "lies on the wall \"" + wall.name +
                                       "\": opening it has no effect; leave a gap in the wall"});
      if (wall.block && wall.block->kind == Region::Kind::box && covers(scene, *wall.block, gate))
        faults.push_back(
            {pointer, "lies in or on the block \"" + wall.name + "\": opening it has no effect"});
    }
  }
}

}  // namespace

long cells_along(const Scene& scene, std::size_t axis) {
  return std::lround(in_cells(scene, axis, scene.domain.max[axis]));
}

bool check_grid(const Scene& scene, Faults& faults) {
  const Domain& domain = scene.domain;
  if (!(scene.cell_size() > 0) || scene.numerics.points_per_cell < 1) {
    faults.push_back(
        {"/domain/cell_size", text(scene.cell_size()) + " m: give cells an edge above 0, and each a point"});
    return false;
  }
  const std::size_t before = faults.size();
  const std::size_t axes = domain.dimension == Dimension::space ? 3 : 2;
  double cells = 1;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double along = in_cells(scene, axis, domain.max[axis]);
    const std::string extent = std::string(1, "xyz"[axis]) + " from " + text(domain.min[axis]) + " to " +
                               text(domain.max[axis]) + " m";
    if (!(along > 0))
      faults.push_back({"/domain/max", "the domain is empty: " + extent});
    else if (!whole(along) || along < 0.5)
      faults.push_back({"/domain/max",
                        extent + " is not a whole number of " + cell_words(scene) + ": the nearest end is " +
                            text(domain.min[axis] + std::max(1.0, std::round(along)) * scene.cell_size()) +
                            " m"});
    cells *= std::max(along, 1.0);
  }
  if (cells > max_cells)
    faults.push_back({"/domain/cell_size", cell_words(scene) + " make " + text(cells) + " of them: at most " +
                                               text(max_cells) +
                                               " are allowed; give larger cells or a smaller domain"});
  return faults.size() == before;
}

void check_lines(const Scene& scene, Faults& faults) {
  check_gates(scene, check_walls(scene, faults), faults);
  for (std::size_t k = 0; k < scene.reservoirs.size(); ++k) {
    const std::string pointer = at_index("reservoirs", k, "/line");
    const auto line = check_line(scene, scene.reservoirs[k].line, pointer, faults);
    if (line && !line->on_edge) faults.push_back({pointer, "does not lie on the domain's edge"});
  }
  for (std::size_t k = 0; k < scene.output.sections.size(); ++k)
    check_line(scene, scene.output.sections[k].line, at_index("output/sections", k, "/line"), faults);
  for (std::size_t k = 0; k < scene.output.probes.size(); ++k)
    if (const Vec3& at = scene.output.probes[k].at; !in_domain(scene, at))
      faults.push_back({at_index("output/probes", k, "/at"), outside_words(scene, at)});
}

}  // namespace quicksand

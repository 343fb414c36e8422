// The grid, and what must lie on its faces: walls, gates and sections.

#include <algorithm>
#include <cmath>

#include "engine/scene/check_parts.hpp"
#include "engine/scene/grid_patch.hpp"

namespace quicksand {
namespace {

/// A limit against slips of the pen; memory is the plan's concern.
constexpr double max_cells = 50e6;

using Patches = std::vector<std::optional<GridPatch>>;

/// True when the block makes the whole patch part of a solid or of its surface.
bool covers(const CellBox& block, const GridPatch& patch) {
  return within(beside(patch, 0), block) || within(beside(patch, 1), block);
}

void check_block(const Scene& scene, const Region& block, const std::string& pointer, Faults& faults) {
  if (block.kind != Region::Kind::box)
    return faults.push_back({pointer, "a block must be a box: use several walls for other shapes"});
  check_box(scene, block, pointer + "/box", faults);
  check_corner(scene, block.min, pointer + "/box/min", faults);
  check_corner(scene, block.max, pointer + "/box/max", faults);
}

/// Walls that another one makes idle. A no-slip line on a smooth block is not: it makes that face rough.
void check_hidden(const Scene& scene, const Patches& lines, Faults& faults) {
  std::vector<std::optional<CellBox>> blocks;
  for (const Wall& wall : scene.walls)
    blocks.push_back(is_box(wall.block) ? std::optional(cell_box(scene, *wall.block)) : std::nullopt);
  for (std::size_t j = 0; j < blocks.size(); ++j) {
    if (!blocks[j]) continue;
    const CellBox& block = *blocks[j];
    const std::string words = "\"" + scene.walls[j].name + "\" and has no effect: remove it";
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      if (j == k) continue;
      const bool roughens = scene.walls[k].no_slip && !scene.walls[j].no_slip;
      const bool buried =
          lines[k] && within(beside(*lines[k], 0), block) && within(beside(*lines[k], 1), block);
      if (lines[k] && covers(block, *lines[k]) && (buried || !roughens))
        faults.push_back({at_index("walls", k, "/line"), "lies in or on the block " + words});
      const bool twin_to_come = blocks[k] == block && k < j;  // of two alike the later is idle
      if (blocks[k] && within(*blocks[k], block) && !twin_to_come)
        faults.push_back({at_index("walls", k, "/block"), "lies within the block " + words});
    }
  }
}

Patches check_walls(const Scene& scene, Faults& faults) {
  Patches lines(scene.walls.size());
  for (std::size_t k = 0; k < scene.walls.size(); ++k) {
    const Wall& wall = scene.walls[k];
    if (wall.block.has_value() == wall.line.has_value())
      faults.push_back({at_index("walls", k), "give exactly one of block and line"});
    if (wall.block) check_block(scene, *wall.block, at_index("walls", k, "/block"), faults);
    if (!wall.line) continue;
    lines[k] = check_patch(scene, *wall.line, at_index("walls", k, "/line"), faults);
    if (lines[k] && on_edge(scene, *lines[k]))
      faults.push_back(
          {at_index("walls", k, "/line"), "lies on the domain's edge and has no effect: set domain.sides"});
  }
  return lines;
}

void check_gate(const Scene& scene, const GridPatch& gate, const Patches& walls, const std::string& pointer,
                Faults& faults) {
  if (on_edge(scene, gate))
    faults.push_back({pointer, "lies on the domain's edge: behind it there is nothing to open to"});
  for (std::size_t j = 0; j < walls.size(); ++j) {
    const Wall& wall = scene.walls[j];
    if (walls[j] && overlap(gate, *walls[j]))
      faults.push_back({pointer, "lies on the wall \"" + wall.name +
                                     "\": opening it has no effect; leave a gap in the wall"});
    if (is_box(wall.block) && covers(cell_box(scene, *wall.block), gate))
      faults.push_back({pointer, "lies in or on the block \"" + wall.name + "\": opening it has no effect"});
  }
}

void check_gates(const Scene& scene, const Patches& walls, Faults& faults) {
  Patches gates(scene.gates.size());
  for (std::size_t k = 0; k < scene.gates.size(); ++k) {
    const std::string pointer = at_index("gates", k, "/line");
    gates[k] = check_patch(scene, scene.gates[k].line, pointer, faults);
    if (!gates[k]) continue;
    check_gate(scene, *gates[k], walls, pointer, faults);
    for (std::size_t j = 0; j < k; ++j)
      if (gates[j] && overlap(*gates[k], *gates[j]))
        faults.push_back(
            {pointer, "lies on the gate \"" + scene.gates[j].name + "\": each piece can have one gate"});
  }
}

/// Whether cells fit along one axis; their number.
double check_extent(const Scene& scene, std::size_t axis, Faults& faults) {
  const Domain& domain = scene.domain;
  const double along = in_cells(scene, axis, domain.max[axis]);
  const std::string extent = std::string(1, "xyz"[axis]) + " from " + text(domain.min[axis]) + " to " +
                             text(domain.max[axis]) + " m";
  if (!(along > 0))
    faults.push_back({"/domain/max", "the domain is empty: " + extent});
  else if (!whole(along) || along < 0.5)
    faults.push_back(
        {"/domain/max", extent + " is not a whole number of " + cell_words(scene) + ": the nearest end is " +
                            text(domain.min[axis] + std::max(1.0, std::round(along)) * scene.cell_size()) +
                            " m"});
  return std::max(along, 1.0);
}

/// About an axis x is the radius.
void check_axis(const Scene& scene, Faults& faults) {
  const double left = scene.domain.min[0];
  if (left < 0)
    faults.push_back({"/domain/min", "x is the radius in an axisymmetric scene: it begins at " + text(left) +
                                         " m and must not be below 0"});
  else if (left > 0 && left < 0.5 * scene.cell_size())
    faults.push_back({"/domain/min", "x begins at " + text(left) + " m, less than half of " +
                                         cell_words(scene) + ": begin at the axis, x = 0, or farther out"});
  const SideKind kind = scene.domain.sides[0].kind;
  if (left == 0 && (kind == SideKind::no_slip || kind == SideKind::open))
    faults.push_back({"/domain/sides/left/kind", "the left side is the axis: leave it out or give symmetry"});
  if (scene.gravity[0] != 0)
    faults.push_back({"/gravity", "must point along the axis: give (0, " + text(scene.gravity[1]) + ")"});
}

}  // namespace

long cells_along(const Scene& scene, std::size_t axis) {
  return axis < axes(scene) ? std::lround(in_cells(scene, axis, scene.domain.max[axis])) : 1;
}

bool is_box(const std::optional<Region>& block) { return block && block->kind == Region::Kind::box; }

bool check_box(const Scene& scene, const Region& box, const std::string& pointer, Faults& faults) {
  bool sound = true;
  for (std::size_t axis = 0; axis < axes(scene); ++axis) sound = sound && box.min[axis] < box.max[axis];
  if (!sound)
    faults.push_back({pointer, "from " + text(scene, box.min) + " to " + text(scene, box.max) +
                                   " is empty: max must exceed min"});
  return sound;
}

bool check_grid(const Scene& scene, Faults& faults) {
  if (!(scene.cell_size() > 0) || scene.numerics.points_per_cell < 1) {
    faults.push_back(
        {"/domain/cell_size", text(scene.cell_size()) + " m: give cells an edge above 0, and each a point"});
    return false;
  }
  const std::size_t before = faults.size();
  double cells = 1;
  for (std::size_t axis = 0; axis < axes(scene); ++axis) cells *= check_extent(scene, axis, faults);
  if (scene.domain.dimension == Dimension::axisymmetric) check_axis(scene, faults);
  if (cells > max_cells)
    faults.push_back({"/domain/cell_size", cell_words(scene) + " make " + text(cells) + " of them: at most " +
                                               text(max_cells) +
                                               " are allowed; give larger cells or a smaller domain"});
  return faults.size() == before;
}

void check_lines(const Scene& scene, Faults& faults) {
  const Patches walls = check_walls(scene, faults);
  check_hidden(scene, walls, faults);
  check_gates(scene, walls, faults);
  check_reservoirs(scene, faults);
  check_sections(scene, faults);
  check_plates(scene, faults);
  check_probe_places(scene, faults);
}

}  // namespace quicksand

// What stands at a place: reservoirs on boundaries, plates on bodies, probes in soil or water.

#include <algorithm>
#include <cmath>

#include "engine/scene/check_parts.hpp"
#include "engine/scene/grid_patch.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

/// The block that lies on one side of the patch, all along it or (`partly`) anywhere.
const Wall* block_beside(const Scene& scene, const GridPatch& patch, int side, bool partly) {
  const CellBox cells = beside(patch, side);
  const auto found = std::find_if(scene.walls.begin(), scene.walls.end(), [&](const Wall& wall) {
    if (!is_box(wall.block)) return false;
    const CellBox block = cell_box(scene, *wall.block);
    return partly ? meet(cells, block) : within(cells, block);
  });
  return found == scene.walls.end() ? nullptr : &*found;
}

/// Whether the patch is a part of the axis, which has no area.
bool on_axis(const Scene& scene, const GridPatch& patch) {
  return scene.domain.dimension == Dimension::axisymmetric && scene.domain.min[0] == 0 && patch.normal == 0 &&
         patch.position() == 0;
}

/// A reservoir's stretch borders the outside: the domain's edge, or a block's face.
void check_stretch(const Scene& scene, const GridPatch& patch, const std::string& pointer, Faults& faults) {
  if (on_axis(scene, patch))
    return faults.push_back({pointer, "lies on the axis: there is no outside behind it"});
  const bool low_solid = patch.position() == 0 || block_beside(scene, patch, 0, false);
  const bool high_solid =
      patch.position() == cells_along(scene, patch.normal) || block_beside(scene, patch, 1, false);
  if (!low_solid && !high_solid)
    return faults.push_back(
        {pointer,
         "lies neither on the domain's edge nor on one face of a wall block: there is no outside "
         "behind it"});
  const Wall* covering = block_beside(scene, patch, low_solid ? 1 : 0, true);
  if (covering)
    faults.push_back({pointer, "is covered by the block \"" + covering->name +
                                   "\", wholly or in part: shorten it to where water can pass"});
}

/// Whether the plate lies on the body, looked at in every column of cells.
bool rests_on(const Scene& scene, const GridPatch& plate, const Body& body) {
  const double h = scene.cell_size(), half_point = 0.5 * h / scene.numerics.points_per_cell;
  const auto at = [&](std::size_t axis, long cell) {
    return scene.domain.min[axis] + (static_cast<double>(cell) + 0.5) * h;
  };
  const double level = scene.domain.min[1] + static_cast<double>(plate.position()) * h;
  const int dimensions = static_cast<int>(axes(scene));
  for (long i = plate.low[0]; i < plate.high[0]; ++i)
    for (long k = plate.low[2]; k < plate.high[2]; ++k) {
      const Vec3 below{at(0, i), level - half_point, at(2, k)}, above{below[0], level + half_point, below[2]};
      if (!contains(body.region, below, dimensions) || contains(body.region, above, dimensions)) return false;
    }
  return true;
}

bool act_together(const Scene& scene, const Load& a, const Load& b) {
  for (std::size_t k = 0; k < scene.stages.size(); ++k)
    if (acts(scene, k, a) && acts(scene, k, b)) return true;
  return false;
}

void check_plate(const Scene& scene, const GridPatch& plate, const Load& load, const std::string& pointer,
                 Faults& faults) {
  if (plate.normal != 1)
    return faults.push_back({pointer, "a plate must be horizontal: give both ends the same y"});
  const auto body = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& b) { return b.name == load.body; });
  if (body != scene.bodies.end() && !rests_on(scene, plate, *body))
    faults.push_back({pointer, "does not lie on top of the body \"" + load.body +
                                   "\" along its whole length: give the body's upper face, or a part of it"});
}

/// The first item whose region, which `fits` names or leaves out, holds the place.
template <typename Items, typename Fits>
const typename Items::value_type* holder(const Scene& scene, const Items& items, const Vec3& at,
                                         const Fits& fits) {
  const int dimensions = static_cast<int>(axes(scene));
  for (const auto& item : items)
    if (const Region* region = fits(item); region && contains(*region, at, dimensions)) return &item;
  return nullptr;
}

/// Whether a place that the block holds does not lie on its surface.
bool inside(const Scene& scene, const Region& block, const Vec3& at) {
  for (std::size_t axis = 0; axis < axes(scene); ++axis) {
    const double cells = in_cells(scene, axis, at[axis]) - in_cells(scene, axis, block.min[axis]);
    if (std::abs(cells) < 0.5 && whole(cells)) return false;
  }
  return true;
}

}  // namespace

void check_reservoirs(const Scene& scene, Faults& faults) {
  std::vector<std::optional<GridPatch>> patches(scene.reservoirs.size());
  for (std::size_t k = 0; k < scene.reservoirs.size(); ++k) {
    const std::string pointer = at_index("reservoirs", k, "/line");
    patches[k] = check_patch(scene, scene.reservoirs[k].line, pointer, faults);
    if (!patches[k]) continue;
    check_stretch(scene, *patches[k], pointer, faults);
    for (std::size_t j = 0; j < k; ++j)
      if (patches[j] && overlap(*patches[k], *patches[j]))
        faults.push_back({pointer, "overlaps the reservoir \"" + scene.reservoirs[j].name +
                                       "\": each piece can have one level"});
  }
  if (scene.gravity == Vec3{0, 0, 0})
    for (std::size_t k = 0; k < scene.reservoirs.size(); ++k)
      faults.push_back({at_index("reservoirs", k, "/head"), "a level means nothing without gravity"});
}

void check_sections(const Scene& scene, Faults& faults) {
  for (std::size_t k = 0; k < scene.output.sections.size(); ++k) {
    const std::string pointer = at_index("output/sections", k, "/line");
    const auto patch = check_patch(scene, scene.output.sections[k].line, pointer, faults);
    if (patch && on_axis(scene, *patch))
      faults.push_back({pointer, "lies on the axis: nothing flows through it"});
  }
}

void check_plates(const Scene& scene, Faults& faults) {
  std::vector<std::optional<GridPatch>> plates(scene.loads.size());
  for (std::size_t k = 0; k < scene.loads.size(); ++k) {
    const Load& load = scene.loads[k];
    if (load.kind != Load::Kind::plate) continue;
    const std::string pointer = at_index("loads", k, "/plate");
    plates[k] = check_patch(scene, load.plate, pointer, faults);
    if (!plates[k]) continue;
    check_plate(scene, *plates[k], load, pointer, faults);
    for (std::size_t j = 0; j < k; ++j)
      if (plates[j] && overlap(*plates[k], *plates[j]) && act_together(scene, load, scene.loads[j]))
        faults.push_back({pointer, "overlaps the plate \"" + scene.loads[j].name +
                                       "\" while both act: name one of them in each stage's loads"});
  }
}

void check_probe_places(const Scene& scene, Faults& faults) {
  for (std::size_t k = 0; k < scene.output.probes.size(); ++k) {
    const Probe& probe = scene.output.probes[k];
    const std::string pointer = at_index("output/probes", k, "/at");
    if (!in_domain(scene, probe.at)) {
      faults.push_back({pointer, outside_words(scene, probe.at)});
      continue;
    }
    const Wall* wall = holder(scene, scene.walls, probe.at, [&](const Wall& w) {
      return is_box(w.block) && inside(scene, *w.block, probe.at) ? &*w.block : nullptr;
    });
    if (wall)
      faults.push_back({pointer, text(scene, probe.at) + " is inside the block \"" + wall->name +
                                     "\", where there is neither soil nor water"});
    const Body* fixed =
        holder(scene, scene.bodies, probe.at, [](const Body& b) { return b.fixed ? &b.region : nullptr; });
    if (fixed && probe.quantity == "soil_velocity")
      faults.push_back({pointer, text(scene, probe.at) + " is in the fixed body \"" + fixed->name +
                                     "\", whose grains never move"});
  }
}

}  // namespace quicksand

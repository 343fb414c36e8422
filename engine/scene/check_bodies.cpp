// Regions of bodies against the domain, the blocks and each other.

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/scene/body_survey.hpp"
#include "engine/scene/check_parts.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

/// Bounds the work of a check: rows times edges stays below a second or two on the largest grid.
constexpr std::size_t max_edges = 20'000;
/// The same in space, where each slab is looked at by itself.
constexpr std::size_t max_edges_in_slabs = 1'000'000;
/// Share of a cell by which a body may reach over the domain, for rounding.
constexpr double slack_in_cells = 1e-6;

/// Faults that a region has by itself; false if it has one.
bool check_region(const Scene& scene, const Region& region, const std::string& pointer, Faults& faults) {
  const std::size_t before = faults.size();
  if (region.kind == Region::Kind::box) check_box(scene, region, pointer + "/box", faults);
  if (region.kind == Region::Kind::polygon && crosses_itself(region.vertices))
    faults.push_back(
        {pointer + "/polygon", "the polygon crosses or touches itself: check the order of its corners"});
  const char* key = region.kind == Region::Kind::union_of ? "/union/" : "/difference/";
  for (std::size_t k = 0; k < region.parts.size(); ++k)
    check_region(scene, region.parts[k], pointer + key + std::to_string(k), faults);
  return faults.size() == before;
}

/// Smallest box around the region; in space polygons and discs go through the whole domain along z.
Bounds bounds_in(const Scene& scene, const Region& region) {
  Bounds bounds = bounding_box(region);
  if (axes(scene) < 3 || region.kind == Region::Kind::box) return bounds;
  bounds.min[2] = scene.domain.max[2], bounds.max[2] = scene.domain.min[2];
  const bool extruded = region.kind == Region::Kind::polygon || region.kind == Region::Kind::disc;
  if (extruded) std::swap(bounds.min[2], bounds.max[2]);
  const std::size_t parts = std::min<std::size_t>(
      region.parts.size(), region.kind == Region::Kind::difference ? 1 : region.parts.size());
  for (std::size_t k = 0; k < parts; ++k) {
    const Bounds part = bounds_in(scene, region.parts[k]);
    bounds.min[2] = std::min(bounds.min[2], part.min[2]);
    bounds.max[2] = std::max(bounds.max[2], part.max[2]);
  }
  return bounds;
}

/// Whether the body lies within the domain, and on cell faces if it is fixed.
void check_bounds(const Scene& scene, const Body& body, const std::string& pointer, Faults& faults) {
  const Bounds box = bounds_in(scene, body.region);
  const double h = scene.cell_size(), slack = slack_in_cells * h;
  bool inside = true, on_faces = true;
  for (std::size_t axis = 0; axis < axes(scene) && !box.empty; ++axis) {
    inside = inside && box.min[axis] >= scene.domain.min[axis] - slack &&
             box.max[axis] <= scene.domain.max[axis] + slack;
    for (const double x : {box.min[axis], box.max[axis]}) {
      const double cells = (x - scene.domain.min[axis]) / h;
      on_faces = on_faces && std::abs(cells - std::round(cells)) <= slack_in_cells;
    }
  }
  if (!inside)
    faults.push_back({pointer, "reaches from " + text(scene, box.min) + " to " + text(scene, box.max) +
                                   ", outside the domain " + text(scene, scene.domain.min) + " to " +
                                   text(scene, scene.domain.max)});
  else if (body.fixed && !on_faces)
    faults.push_back({pointer, "a fixed body must fill whole " + cell_words(scene) + "; it reaches from " +
                                   text(scene, box.min) + " to " + text(scene, box.max)});
}

void report(const Scene& scene, const Survey& survey, const std::set<std::size_t>& faulty, Faults& faults) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    if (faulty.contains(k)) continue;
    const std::string pointer = at_index("bodies", k, "/region");
    if (survey.points[k] == 0)
      faults.push_back({pointer, "holds no point at " + cell_words(scene) + " with " +
                                     std::to_string(scene.numerics.points_per_cell) +
                                     " points per axis: make it larger or the cells smaller"});
    else if (const Overlap& blocked = survey.in_blocks[k]; blocked.points > 0)
      faults.push_back({pointer, "reaches into a wall block near " + text(scene, blocked.place) + " (" +
                                     std::to_string(blocked.points) + " of " +
                                     std::to_string(survey.points[k]) +
                                     " points): cut the block out, for instance with a difference"});
    else if (scene.bodies[k].fixed && survey.cuts_cells[k])
      faults.push_back(
          {pointer, "a fixed body must fill whole " + cell_words(scene) + ": some are filled partly"});
  }
  for (const auto& [pair, overlap] : survey.overlaps)
    faults.push_back({at_index("bodies", pair.second, "/region"),
                      "overlaps the body \"" + scene.bodies[pair.first].name + "\" near " +
                          text(scene, overlap.place) + " (" + std::to_string(overlap.points) +
                          " points): cut one of them, for instance with a difference"});
}

}  // namespace

void check_bodies(const Scene& scene, Faults& faults) {
  std::size_t edges = 0;
  for (const Body& body : scene.bodies) edges += edge_count(body.region);
  for (const Wall& wall : scene.walls) edges += wall.block ? edge_count(*wall.block) : 0;
  if (edges > max_edges)
    return faults.push_back({"/bodies", "regions and blocks have " + std::to_string(edges) +
                                            " edges: at most " + std::to_string(max_edges) +
                                            " are allowed; simplify polygons"});
  const std::vector<Slab> slabs = slabs_of(scene);
  if (edges * slabs.size() > max_edges_in_slabs)
    return faults.push_back({"/bodies", "boxes of bodies and blocks begin or end at " +
                                            std::to_string(slabs.size()) +
                                            " depths z, which is too many beside " + std::to_string(edges) +
                                            " edges: let more of them share their z"});
  std::set<std::size_t> faulty;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const std::string pointer = at_index("bodies", k, "/region");
    const std::size_t before = faults.size();
    if (check_region(scene, scene.bodies[k].region, pointer, faults))
      check_bounds(scene, scene.bodies[k], pointer, faults);
    if (faults.size() > before) faulty.insert(k);
  }
  report(scene, survey_bodies(scene, slabs), faulty, faults);
}

}  // namespace quicksand

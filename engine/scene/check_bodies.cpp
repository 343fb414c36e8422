// Bodies against the domain, the blocks and each other, by the points that would be seeded: point (i, j) of a
// grid of points_per_cell per cell and axis lies at domain.min + ((i, j) + ½) cell_size / points_per_cell.
// Rows of points are cut with the regions as intervals, so the cost grows with the rows, not the points.

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/scene/check_parts.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

/// Bounds the work of a check: rows times edges stays below a second or two on the largest grid.
constexpr std::size_t max_edges = 20'000;
/// Share of a cell by which a body may reach over the domain, for rounding.
constexpr double slack_in_cells = 1e-6;

/// Half-open range of point indices in a row.
struct Range {
  long from, to;
  bool operator==(const Range&) const = default;
};
using Ranges = std::vector<Range>;

long length(const Ranges& ranges) {
  long sum = 0;
  for (const Range& r : ranges) sum += r.to - r.from;
  return sum;
}

/// The rows of points; they run along the longer side of the domain so that there are few.
struct Rows {
  explicit Rows(const Scene& s) : scene(s) {
    axis = cells_along(s, 0) >= cells_along(s, 1) ? 0 : 1;
    per_cell = s.numerics.points_per_cell;
    spacing = s.cell_size() / static_cast<double>(per_cell);
    points = cells_along(s, axis) * per_cell;
    count = cells_along(s, 1 - axis) * per_cell;
  }

  /// To the last bit the coordinate that seeding gives the point.
  double coordinate(std::size_t along, long index) const {
    const auto cell = static_cast<double>(index / per_cell), in_cell = static_cast<double>(index % per_cell);
    return scene.domain.min[along] +
           (cell + (in_cell + 0.5) / static_cast<double>(per_cell)) * scene.cell_size();
  }
  /// First point at or above the coordinate.
  long first_from(double x) const {
    long i = std::lround(
        std::clamp((x - scene.domain.min[axis]) / spacing - 0.5, -1.0, static_cast<double>(points)));
    while (i > 0 && coordinate(axis, i - 1) >= x) --i;
    while (i < points && coordinate(axis, i) < x) ++i;
    return std::max(i, 0L);
  }
  Ranges cut(const Region& region, long row) const {
    Ranges ranges;
    for (const auto& s : stretches(region, static_cast<int>(axis), coordinate(1 - axis, row)))
      if (const Range r{first_from(s[0]), first_from(s[1])}; r.from < r.to) ranges.push_back(r);
    return ranges;
  }
  Vec3 place(long row, long index) const {
    Vec3 p{};
    p[axis] = coordinate(axis, index);
    p[1 - axis] = coordinate(1 - axis, row);
    return p;
  }

  const Scene& scene;
  std::size_t axis = 0;
  long per_cell = 1, points = 0, count = 0;
  double spacing = 0;
};

struct Overlap {
  long points = 0;
  Vec3 place{};
};

/// What the rows say about all bodies.
struct Survey {
  std::vector<long> points;        ///< per body
  std::vector<Overlap> in_blocks;  ///< per body
  std::vector<bool> cuts_cells;    ///< per body: some cell is only partly covered
  std::map<std::pair<std::size_t, std::size_t>, Overlap> overlaps;  ///< first body, later body
};

struct Marked {
  Range range;
  std::size_t body;
};

/// Parts of `ranges` inside the blocks; both sorted.
Ranges common(const Ranges& ranges, const Ranges& blocks) {
  Ranges both;
  for (const Range& r : ranges)
    for (const Range& b : blocks)
      if (const Range c{std::max(r.from, b.from), std::min(r.to, b.to)}; c.from < c.to) both.push_back(c);
  return both;
}

/// Compares each range with the one that reaches farthest so far: finds an overlap of every body that has
/// one.
void note_overlaps(const Rows& rows, long row, std::vector<Marked>& marked, Survey& survey) {
  std::sort(marked.begin(), marked.end(), [](const Marked& a, const Marked& b) {
    return std::pair(a.range.from, a.body) < std::pair(b.range.from, b.body);
  });
  const Marked* farthest = nullptr;
  for (const Marked& m : marked) {
    if (farthest && m.range.from < farthest->range.to && m.body != farthest->body) {
      Overlap& overlap = survey.overlaps[std::minmax(m.body, farthest->body)];
      if (overlap.points == 0) overlap.place = rows.place(row, m.range.from);
      overlap.points += std::min(m.range.to, farthest->range.to) - m.range.from;
    }
    if (!farthest || m.range.to > farthest->range.to) farthest = &m;
  }
}

bool cell_aligned(const Ranges& ranges, long per_cell) {
  return std::all_of(ranges.begin(), ranges.end(),
                     [&](const Range& r) { return r.from % per_cell == 0 && r.to % per_cell == 0; });
}

/// All blocks as one region.
Region blocks_of(const Scene& scene) {
  Region blocks;
  blocks.kind = Region::Kind::union_of;
  for (const Wall& wall : scene.walls)
    if (wall.block && wall.block->kind == Region::Kind::box) blocks.parts.push_back(*wall.block);
  return blocks;
}

Survey survey_bodies(const Scene& scene) {
  const Rows rows(scene);
  const std::size_t bodies = scene.bodies.size();
  Survey survey{std::vector<long>(bodies), std::vector<Overlap>(bodies), std::vector<bool>(bodies), {}};
  std::vector<Ranges> first_of_cell(bodies);
  std::vector<Marked> marked;
  const Region block_region = blocks_of(scene);
  for (long row = 0; row < rows.count; ++row) {
    const Ranges blocks = rows.cut(block_region, row);
    marked.clear();
    for (std::size_t k = 0; k < bodies; ++k) {
      const Ranges ranges = rows.cut(scene.bodies[k].region, row);
      if (row % rows.per_cell == 0) first_of_cell[k] = ranges;
      if (ranges != first_of_cell[k] || !cell_aligned(ranges, rows.per_cell)) survey.cuts_cells[k] = true;
      survey.points[k] += length(ranges);
      for (const Range& r : ranges) marked.push_back({r, k});
      const Ranges blocked = common(ranges, blocks);
      if (blocked.empty()) continue;
      if (survey.in_blocks[k].points == 0) survey.in_blocks[k].place = rows.place(row, blocked.front().from);
      survey.in_blocks[k].points += length(blocked);
    }
    note_overlaps(rows, row, marked, survey);
  }
  return survey;
}

/// Faults that a region has by itself; false if it has one.
bool check_region(const Region& region, const std::string& pointer, Faults& faults) {
  const std::size_t before = faults.size();
  if (region.kind == Region::Kind::box && !(region.min[0] < region.max[0] && region.min[1] < region.max[1]))
    faults.push_back({pointer + "/box", "from " + text(region.min) + " to " + text(region.max) +
                                            " is empty: max must exceed min"});
  if (region.kind == Region::Kind::polygon && crosses_itself(region.vertices))
    faults.push_back(
        {pointer + "/polygon", "the polygon crosses or touches itself: check the order of its corners"});
  const char* key = region.kind == Region::Kind::union_of ? "/union/" : "/difference/";
  for (std::size_t k = 0; k < region.parts.size(); ++k)
    check_region(region.parts[k], pointer + key + std::to_string(k), faults);
  return faults.size() == before;
}

/// Whether the body lies within the domain, and on cell faces if it is fixed.
void check_bounds(const Scene& scene, const Body& body, const std::string& pointer, Faults& faults) {
  const Bounds box = bounding_box(body.region);
  const double h = scene.cell_size(), slack = slack_in_cells * h;
  bool inside = true, on_faces = true;
  for (std::size_t axis = 0; axis < 2 && !box.empty; ++axis) {
    inside = inside && box.min[axis] >= scene.domain.min[axis] - slack &&
             box.max[axis] <= scene.domain.max[axis] + slack;
    for (const double x : {box.min[axis], box.max[axis]}) {
      const double cells = (x - scene.domain.min[axis]) / h;
      on_faces = on_faces && std::abs(cells - std::round(cells)) <= slack_in_cells;
    }
  }
  if (!inside)
    faults.push_back({pointer, "reaches from " + text(box.min) + " to " + text(box.max) +
                                   ", outside the domain " + text(scene.domain.min) + " to " +
                                   text(scene.domain.max)});
  else if (body.fixed && !on_faces)
    faults.push_back({pointer, "a fixed body must fill whole " + cell_words(scene) + "; it reaches from " +
                                   text(box.min) + " to " + text(box.max)});
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
      faults.push_back({pointer, "reaches into a wall block near " + text(blocked.place) + " (" +
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
                          text(overlap.place) + " (" + std::to_string(overlap.points) +
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
  std::set<std::size_t> faulty;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const std::string pointer = at_index("bodies", k, "/region");
    const std::size_t before = faults.size();
    if (check_region(scene.bodies[k].region, pointer, faults))
      check_bounds(scene, scene.bodies[k], pointer, faults);
    if (faults.size() > before) faulty.insert(k);
  }
  report(scene, survey_bodies(scene), faulty, faults);
}

}  // namespace quicksand

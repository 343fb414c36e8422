// Rows of points are cut with the regions as intervals, so the cost grows with the rows, not the points; in
// space, layers of points between two faces of boxes are alike and looked at once.

#include "engine/scene/body_survey.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/scene/check_parts.hpp"
#include "engine/scene/region.hpp"

namespace quicksand {
namespace {

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

/// The rows of points of a slab; they run along the longer side of the domain so that there are few.
struct Rows {
  Rows(const Scene& s, const Slab& of) : Rows(s, cells_along(s, 0) >= cells_along(s, 1) ? 0 : 1) {
    slab = of;
    count = cells_along(s, 1 - axis) * per_cell;
  }
  /// Only the points along an axis.
  Rows(const Scene& s, std::size_t along) : scene(s), axis(along) {
    per_cell = s.numerics.points_per_cell;
    spacing = s.cell_size() / static_cast<double>(per_cell);
    points = cells_along(s, axis) * per_cell;
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
    p[2] = slab.depth;
    return p;
  }

  const Scene& scene;
  Slab slab{};
  std::size_t axis = 0;
  long per_cell = 1, points = 0, count = 0;
  double spacing = 0;
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
      overlap.points +=
          (std::min(m.range.to, farthest->range.to) - m.range.from) * (rows.slab.to - rows.slab.from);
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

/// What a slab cuts out of the bodies and blocks.
struct Cut {
  std::vector<Region> bodies;
  Region blocks;
};

Cut cut_at(const Scene& scene, const Slab& slab) {
  Cut cut{{}, blocks_of(scene)};
  for (const Body& body : scene.bodies) cut.bodies.push_back(body.region);
  if (axes(scene) < 3) return cut;
  for (Region& region : cut.bodies) region = at_depth(std::move(region), slab.depth);
  cut.blocks = at_depth(std::move(cut.blocks), slab.depth);
  return cut;
}

void survey_slab(const Rows& rows, const Cut& cut, Survey& survey) {
  const long layers = rows.slab.to - rows.slab.from;
  std::vector<Ranges> first_of_cell(cut.bodies.size());
  std::vector<Marked> marked;
  for (long row = 0; row < rows.count; ++row) {
    const Ranges blocks = rows.cut(cut.blocks, row);
    marked.clear();
    for (std::size_t k = 0; k < cut.bodies.size(); ++k) {
      const Ranges ranges = rows.cut(cut.bodies[k], row);
      if (row % rows.per_cell == 0) first_of_cell[k] = ranges;
      if (ranges != first_of_cell[k] || !cell_aligned(ranges, rows.per_cell)) survey.cuts_cells[k] = true;
      survey.points[k] += length(ranges) * layers;
      for (const Range& r : ranges) marked.push_back({r, k});
      const Ranges blocked = common(ranges, blocks);
      if (blocked.empty()) continue;
      if (survey.in_blocks[k].points == 0) survey.in_blocks[k].place = rows.place(row, blocked.front().from);
      survey.in_blocks[k].points += length(blocked) * layers;
    }
    note_overlaps(rows, row, marked, survey);
  }
}

/// Depths at which some box begins or ends.
void add_depths(const Region& region, std::vector<double>& depths) {
  if (region.kind == Region::Kind::box) depths.insert(depths.end(), {region.min[2], region.max[2]});
  for (const Region& part : region.parts) add_depths(part, depths);
}

/// Notes bodies that change within the layers of one cell.
void compare_slabs(const Rows& rows, const Cut& before, const Cut& after, Survey& survey) {
  for (std::size_t k = 0; k < after.bodies.size(); ++k)
    for (long row = 0; row < rows.count && !survey.cuts_cells[k]; ++row)
      survey.cuts_cells[k] = rows.cut(before.bodies[k], row) != rows.cut(after.bodies[k], row);
}

}  // namespace

std::vector<Slab> slabs_of(const Scene& scene) {
  if (axes(scene) < 3) return {Slab{}};
  std::vector<double> depths;
  for (const Body& body : scene.bodies) add_depths(body.region, depths);
  add_depths(blocks_of(scene), depths);
  const Rows layers(scene, 2);
  std::set<long> begins{0};
  for (const double z : depths) begins.insert(layers.first_from(z));
  begins.erase(layers.points);
  std::vector<Slab> slabs;
  for (auto begin = begins.begin(); begin != begins.end(); ++begin)
    slabs.push_back({*begin, std::next(begin) == begins.end() ? layers.points : *std::next(begin),
                     layers.coordinate(2, *begin)});
  return slabs;
}

Survey survey_bodies(const Scene& scene, const std::vector<Slab>& slabs) {
  const std::size_t bodies = scene.bodies.size();
  Survey survey{std::vector<long>(bodies), std::vector<Overlap>(bodies), std::vector<bool>(bodies), {}};
  Cut before;
  for (const Slab& slab : slabs) {
    const Rows rows(scene, slab);
    Cut cut = cut_at(scene, slab);
    survey_slab(rows, cut, survey);
    if (slab.from % rows.per_cell != 0) compare_slabs(rows, before, cut, survey);
    before = std::move(cut);
  }
  return survey;
}

}  // namespace quicksand

#include "tests/bench/scenes.hpp"

#include <cmath>

#include "engine/scene/scene.hpp"

namespace quicksand::bench {
namespace {

constexpr double kWidth = 1;  ///< m
/// Head that drives water through the bed, over what lifts it: it heaves.
constexpr double kOverCritical = 1.2;
/// Lower parts of the domain's width: bed, its pond's level, column, depth in space.
constexpr double kBed = 0.5, kLevel = 0.75, kColumnWidth = 0.25, kColumnHeight = 0.5, kDepth = 0.25;
constexpr double kDomainHeight = 1;

Soil sand() {
  Soil soil;
  soil.permeability.value = 1e-4;
  soil.model = {.law = SoilLaw::mohr_coulomb,
                .young_modulus = 1e7,
                .poisson_ratio = 0.3,
                .friction_angle = 30,
                .dilation_angle = 5};
  return soil;
}

void add_body(Scene& s, const std::string& name, BodyKind kind, const Vec3& min, const Vec3& max) {
  Body body;
  body.name = name;
  body.kind = kind;
  body.region.min = min, body.region.max = max;
  if (kind != BodyKind::water) {
    body.soil = "sand";
    s.soils["sand"] = sand();
  }
  s.bodies.push_back(body);
}

/// Sand up to `bed` and water up to `level`, both parts of the width.
void fill_bed(Scene& s, double bed, double level) {
  const double depth = s.domain.max[2];
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {kWidth, bed, depth});
  add_body(s, "pond", BodyKind::water, {0, bed, 0}, {kWidth, level, depth});
  const Soil& soil = s.soils["sand"];
  const double critical = (1 - soil.porosity) * (soil.grain_density / s.water.density - 1);
  s.reservoirs = {{"below", {{0, 0, 0}, {kWidth, 0, depth}}, level + kOverCritical * critical * bed}};
}

/// Cells over the width for about `points` points, a multiple of 4 so that bodies end on cell faces.
int cells_across(Kind kind, const SceneSize& size) {
  const double plane = kind == Kind::bed ? kBed + kLevel : kColumnWidth * kColumnHeight;
  const double per_width = size.dimensions == 2 ? 4 * plane : 8 * plane * kDepth;
  return 4 * static_cast<int>(std::lround(std::pow(size.points / per_width, 1.0 / size.dimensions) / 4));
}

Scene empty_scene(const std::string& name, int dimensions, double cell_size) {
  Scene s;
  s.name = name;
  s.domain.dimension = dimensions == 2 ? Dimension::plane_strain : Dimension::space;
  s.domain.cell_size = cell_size;
  s.domain.max = {kWidth, kDomainHeight, dimensions == 2 ? 0 : kDepth};
  s.stages = {Stage{}};
  s.stages[0].name = "only";
  s.stages[0].duration = 1;
  return s;
}

}  // namespace

Scene make_scene(Kind kind, const SceneSize& size) {
  Scene s =
      empty_scene(scene_name(kind, size.dimensions), size.dimensions, kWidth / cells_across(kind, size));
  const double depth = s.domain.max[2];
  if (kind == Kind::bed) {
    fill_bed(s, kBed, kLevel);
    if (size.room > 1)
      s.walls = {{"side", {}, Segment{{kWidth, 0, 0}, {kWidth, kDomainHeight, depth}}, false}};
  } else {
    add_body(s, "column", kind == Kind::column ? BodyKind::soil : BodyKind::water, {0, 0, 0},
             {kColumnWidth, kColumnHeight, depth});
  }
  s.domain.max[0] *= size.room, s.domain.max[1] *= size.room;
  return s;
}

Scene make_square(Kind kind, int cells) {
  Scene s = empty_scene(scene_name(kind, 2), 2, kWidth / cells);
  if (kind == Kind::bed) {
    s.domain.max[1] = 1.25 * kWidth;
    fill_bed(s, 0.5 * kWidth, kWidth);
  } else {
    s.domain.max[0] = 1.5 * kWidth;
    s.domain.max[1] = 1.25 * kWidth;
    add_body(s, "block", BodyKind::water, {0, 0, 0}, {kWidth, kWidth, 0});
  }
  return s;
}

const std::vector<NamedKind>& kinds() {
  static const std::vector<NamedKind> all{{"bed", Kind::bed}, {"column", Kind::column}, {"dam", Kind::dam}};
  return all;
}

std::string scene_name(Kind kind, int dimensions) {
  return kinds()[static_cast<std::size_t>(kind)].name + std::to_string(dimensions);
}

}  // namespace quicksand::bench

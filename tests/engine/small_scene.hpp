#pragma once
// Small scenes that the engine's tests share.

#include <string>

#include "engine/scene/scene.hpp"

namespace quicksand::test {

inline Region box(const Vec3& min, const Vec3& max) {
  Region r;
  r.min = min, r.max = max;
  return r;
}

/// A plane domain from (0, 0) to (width, height) on cells of h metres with one stage of `duration` seconds.
inline Scene plane(double width, double height, double h, double duration = 1) {
  Scene s;
  s.domain.max = {width, height, 0};
  s.domain.cell_size = h;
  s.stages = {Stage{}};
  s.stages[0].name = "only";
  s.stages[0].duration = duration;
  return s;
}

inline Scene space(const Vec3& size, double h, double duration = 1) {
  Scene s = plane(size[0], size[1], h, duration);
  s.domain.dimension = Dimension::space;
  s.domain.max = size;
  return s;
}

/// Sand of E = 10 MPa, n = 0.4, k = 1e-4 m/s, φ = 30°.
inline Soil sand() {
  Soil soil;
  soil.permeability.value = 1e-4;
  soil.model = {
      .law = SoilLaw::mohr_coulomb, .young_modulus = 1e7, .poisson_ratio = 0.3, .friction_angle = 30};
  return soil;
}

inline void add_body(Scene& s, const std::string& name, BodyKind kind, const Vec3& min, const Vec3& max) {
  Body body;
  body.name = name;
  body.kind = kind;
  body.region = box(min, max);
  if (kind != BodyKind::water) {
    body.soil = "sand";
    s.soils.emplace("sand", sand());
  }
  s.bodies.push_back(body);
}

}  // namespace quicksand::test

#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "engine/scene/check.hpp"

namespace quicksand::test {

inline Region box(double x0, double y0, double x1, double y1) {
  Region r;
  r.min = {x0, y0, 0}, r.max = {x1, y1, 0};
  return r;
}

/// A basin 1 m × 1 m on cells of 0.1 m: sand below, water above.
inline Scene basin() {
  Scene s;
  s.domain.cell_size = 0.1;
  Soil sand;
  sand.permeability.value = 1e-4;
  sand.model = {.law = SoilLaw::mohr_coulomb,
                .young_modulus = 1e7,
                .poisson_ratio = 0.3,
                .friction_angle = 30,
                .dilation_angle = 5};
  s.soils["sand"] = sand;
  s.bodies = {{"sand", BodyKind::saturated_soil, "sand", box(0, 0, 1, 0.3), false, {}},
              {"water", BodyKind::water, "", box(0, 0.3, 1, 0.6), false, {}}};
  s.stages = {{}};
  s.stages[0].name = "rest";
  s.stages[0].duration = 1;
  return s;
}

inline std::vector<std::string> faults_of(const Scene& scene) {
  std::vector<std::string> pointers;
  for (const Fault& fault : check(scene)) pointers.push_back(fault.pointer);
  std::sort(pointers.begin(), pointers.end());
  return pointers;
}

using Pointers = std::vector<std::string>;

inline Pointers after(const std::function<void(Scene&)>& change) {
  Scene scene = basin();
  change(scene);
  return faults_of(scene);
}

}  // namespace quicksand::test

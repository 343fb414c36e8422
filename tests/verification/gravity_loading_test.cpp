// Ground without stress and pressure under its sudden weight comes to rest as elastic layers between smooth
// walls do: σ′v = ∫ γ′ dz (γ dry), σ′h = ν/(1−ν) σ′v, u = γw · depth. See cases/gravity-loading/README.md.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// cases/gravity-loading.
constexpr double kFace = 0.5, kTop = 1, kLevel = 1.2, kWater = 9810, kGravity = 9.81;
/// The jump of stiffness between the layers shows for so many cells in the strain that quadratic splines
/// make.
constexpr double kReach = 3;
constexpr double kDryFreeTime = 3;  ///< s, after which the dry ground without damping is left swinging

struct Layer {
  double weight = 0;    ///< N/m³
  double modulus = 0;   ///< Pa, constrained
  double sideways = 0;  ///< –, ν/(1−ν)
};
Layer layer(const Scene& scene, const std::string& soil, bool dry) {
  const Soil& s = scene.soils.at(soil);
  const double nu = s.model.poisson_ratio, e = s.model.young_modulus;
  return {(1 - s.porosity) * (s.grain_density - (dry ? 0 : 1000)) * kGravity,
          e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), nu / (1 - nu)};
}

struct Ground {
  Layer lower, upper;
  Ground(const Scene& scene, bool dry)
      : lower(layer(scene, "dense", dry)), upper(layer(scene, "loose", dry)) {}
  double vertical(double y) const {
    return y > kFace ? upper.weight * (kTop - y) : upper.weight * (kTop - kFace) + lower.weight * (kFace - y);
  }
  double sideways(double y) const { return (y > kFace ? upper : lower).sideways * vertical(y); }
  double settlement() const {
    const double t = kTop - kFace, at_face = vertical(kFace), at_base = vertical(0);
    return at_face / 2 * t / upper.modulus + (at_face + at_base) / 2 * kFace / lower.modulus;
  }
};

Scene without_water(Scene s) {
  std::erase_if(s.bodies, [](const Body& b) { return b.kind == BodyKind::water; });
  for (Body& body : s.bodies) body.kind = BodyKind::soil;
  return s;
}
Scene permeable(Scene s, double times) {
  for (auto& [name, soil] : s.soils) soil.permeability.value *= times;
  return s;
}
Scene damped(Scene s, double damping) {
  s.stages[0].damping = damping;
  return s;
}

struct Errors {
  double vertical = 0, sideways = 0, near_face = 0, cell_mean = 0, pressure = 0, settlement = 0;
};

/// Of the last frame; stresses as parts of those at the base.
Errors errors(const Recorded& r, const Ground& ground, double h, Curve* profile = nullptr) {
  const Frame& last = r.results.frames.back();
  const auto &stress = field(last, "effective_stress"), &u = field(last, "displacement"),
             &p = field(last, "pore_pressure");
  Errors e;
  std::map<long, std::pair<double, int>> cells;
  double first = 0, second = 0;  // settlement of the two highest rows
  for (std::size_t i = 0; i < last.points(); ++i) {
    const double y = last.position[3 * i + 1];
    if (last.phase[i] == 1) {
      e.pressure = std::max(e.pressure, std::abs(p[i] - kWater * (kLevel - y)) / (kWater * kLevel));
      continue;
    }
    const double start = y - u[3 * i + 1], z = kTop - start;
    const double v = (-stress[4 * i + 1] - ground.vertical(start)) / ground.vertical(0);
    const double s = (-stress[4 * i] - ground.sideways(start)) / ground.sideways(0);
    const bool near = std::abs(start - kFace) < kReach * h;
    (near ? e.near_face : e.vertical) = std::max(near ? e.near_face : e.vertical, std::abs(v));
    if (!near) e.sideways = std::max(e.sideways, std::abs(s));
    auto& [sum, count] = cells[std::lround(start / h - 0.5)];
    sum += v, ++count;
    if (z < 0.5 * h) first = -u[3 * i + 1];
    if (z > 0.5 * h && z < h) second = -u[3 * i + 1];
    if (profile) profile->x.push_back(-stress[4 * i + 1] / 1e3), profile->result.push_back(start);
  }
  for (const auto& [cell, sum] : cells) e.cell_mean = std::max(e.cell_mean, std::abs(sum.first) / sum.second);
  e.settlement = first + 0.5 * (first - second);
  return e;
}

Curve speed(const Recorded& r, const std::string& label) {
  Curve c{"Largest speed of dry ground", "t (s)", "log10 of m/s", label, {}, {}};
  const auto v = r.results.series("max_speed");
  for (std::size_t i = 1; i < v.size(); ++i)
    c.x.push_back(r.results.times[i]), c.result.push_back(std::log10(std::max(v[i], 1e-7)));
  return c;
}

/// How many steps it takes with damping and without: dry, as in the case, and so permeable that the water
/// damps next to nothing.
void count_steps(Page& page, const Scene& scene, const std::string& size) {
  const auto run = [&](const Scene& s, double damping, const std::string& what) {
    const std::string label = what + (damping > 0 ? ", damping 0.7" : ", no damping");
    const Recorded r = page.run(damped(s, damping), {}, label + ", steps");
    page.value("steps to rest, " + label, static_cast<double>(r.report.steps), "");
    return r;
  };
  Scene dry = without_water(scene);
  const double rests = static_cast<double>(run(dry, 0.7, "dry").report.steps);
  dry.stages[0].duration = kDryFreeTime;
  const Recorded swings = run(dry, 0, "dry (swings on after 3 s)");
  EXPECT_GT(swings.results.last("max_speed"), 1e-3);
  EXPECT_GT(static_cast<double>(swings.report.steps), 4 * rests);
  run(scene, 0.7, "saturated"), run(scene, 0, "saturated");
  const Scene gravel = permeable(scene, 100);
  const Recorded loose = run(gravel, 0, "k × 100"), stones = run(gravel, 0.7, "k × 100");
  EXPECT_GT(loose.report.steps, 2 * stones.report.steps);
  page.curve(speed(swings, "no damping, " + size));
}

void gravity_page(double factor, const std::string& size, bool counts_steps) {
  Page page("gravity-loading", size);
  const Scene scene = load_case("gravity-loading", factor);
  const double h = scene.cell_size();

  const Recorded wet = page.run(scene, {}, "saturated, damping 0.7");
  EXPECT_LT(wet.report.sim_time, 0.5 * scene.stages[0].duration);  // it ended at rest
  const Ground buoyant(scene, false), heavy(scene, true);
  Curve profile{"Vertical effective stress at rest", "σ′v (kPa)", "height (m)", "saturated, " + size, {}, {}};
  profile.reference_x = {buoyant.vertical(0) / 1e3, buoyant.vertical(kFace) / 1e3, 0};
  profile.reference = {0, kFace, kTop};
  const Errors e = errors(wet, buoyant, h, &profile);
  page.error("pore pressure, all points", e.pressure, 0.005, "γw · depth of the base");
  page.error("σ′v, away from the layers' face", e.vertical, 0.01, "σ′v at the base");
  page.error("σ′h, away from the layers' face", e.sideways, 0.01, "σ′h at the base");
  page.missed_error("σ′v within 3 cells of the layers' face", e.near_face, 0.01, 0.25, "σ′v at the base");
  page.near("settlement of the surface", e.settlement, buoyant.settlement(), 0.01, "m");

  Scene hats = scene;
  hats.numerics.kernel = Kernel::linear;
  const Recorded linear = page.run(hats, {}, "saturated, damping 0.7, linear kernel");
  page.error("σ′v, linear kernel, mean of every cell", errors(linear, buoyant, h).cell_mean, 0.005,
             "σ′v at the base");

  const Recorded rests = page.run(without_water(scene), {}, "dry, damping 0.7");
  const Errors d = errors(rests, heavy, h);
  page.error("dry: σ′v, away from the layers' face", d.vertical, 0.01, "σ′v at the base");
  page.near("dry: settlement of the surface", d.settlement, heavy.settlement(), 0.01, "m");

  page.curve(profile);
  page.curve(speed(rests, "damping 0.7, " + size));
  if (counts_steps) count_steps(page, scene, size);
}

TEST(GravityLoading, ComesToRestUnderItsWeight) {
  gravity_page(2, "cells of 50 mm", true);
  gravity_page(1, "cells of 25 mm", false);
}

}  // namespace
}  // namespace quicksand::test

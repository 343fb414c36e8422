// The hydraulic heave of cases/heave, held to what the case promises. The fast tests run its draft for the
// first half second after the valve opens; the slow ones run draft and standard to the end.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "api/case_json.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {
namespace {

// Geometry of cases/heave, m.
constexpr double kGate = 0.18, kPoolLevel = 0.22, kBlockLeft = 0.16, kBlockRight = 0.22, kBlockLow = 0.04,
                 kFilterTop = 0.06;
constexpr double kEquilibrium = 0.25;  ///< s

Scene load(const std::string& name, Preset preset) {
  std::ifstream file(std::string(QUICKSAND_CASES) + "/" + name + "/case.json");
  std::stringstream text;
  text << file.rdbuf();
  const ParsedCase parsed = parse_case(text.str(), preset);
  if (!parsed.scene)
    throw std::runtime_error(name + ": " + parsed.faults.front().pointer + " " +
                             parsed.faults.front().detail);
  return *parsed.scene;
}

Scene shortened(const std::string& name, double seconds_open) {
  Scene scene = load(name, Preset::draft);
  scene.stages[1].duration = seconds_open;
  return scene;
}

void expect_equilibrium(const Scene& scene, const Recorded& r, double tank_level) {
  double worst = 0, fastest = 0, moved = 0;
  int frames = 0;
  for (const Frame& frame : r.results.frames) {
    if (frame.time > kEquilibrium + 1e-9) break;
    ++frames;
    const auto& p = field(frame, "pore_pressure");
    const auto& v = field(frame, "velocity");
    const auto& u = field(frame, "displacement");
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double level = frame.position[3 * i] < kGate ? tank_level : kPoolLevel;
      const double expected = 9810 * (level - frame.position[3 * i + 1]);
      worst = std::max(worst, std::abs(p[i] - expected) / expected);
      if (frame.phase[i] == 0) {
        fastest = std::max(fastest, static_cast<double>(std::hypot(v[3 * i], v[3 * i + 1])));
        moved = std::max(moved, static_cast<double>(std::hypot(u[3 * i], u[3 * i + 1])));
      }
    }
  }
  std::printf("h = %g m, equilibrium: pressure %.1e, grains %.1e m/s, moved %.1e m\n", scene.cell_size(),
              worst, fastest, moved);
  EXPECT_GE(frames, 5);
  EXPECT_LT(worst, 0.01) << "of the hydrostatic pressure at the point";
  EXPECT_LT(fastest, 1e-4);
  EXPECT_LT(moved, 1e-4);
}

void expect_conservation(const Recorded& r) {
  const Ledger& l = r.report.ledger;
  std::printf("volume drift %.2e, momentum residual %.1e, clipped %ld, clamped %ld, cut %ld\n",
              l.water_volume_drift_max, l.momentum_residual, l.clipped_points, l.clamped_values, l.cut_steps);
  EXPECT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  EXPECT_LT(l.water_volume_drift_max, 0.005);
  EXPECT_NEAR(l.water_mass / l.water_mass_initial, 1, 1e-12);
  EXPECT_NEAR(l.solid_mass / l.solid_mass_initial, 1, 1e-12);
  EXPECT_LT(l.momentum_residual, 1e-6);
  EXPECT_EQ(l.deleted_points, 0);
  EXPECT_EQ(r.results.frames.front().points(), r.results.frames.back().points());
}

/// No point in the partition, none outside the domain, none through the closed gate.
void expect_no_leak(const Scene& scene, const Recorded& r) {
  const auto& first = r.results.frames.front();
  for (const Frame& frame : r.results.frames)
    for (std::size_t i = 0; i < frame.points(); ++i) {
      const double x = frame.position[3 * i], y = frame.position[3 * i + 1];
      ASSERT_FALSE(x > kBlockLeft && x < kBlockRight && y > kBlockLow)
          << x << " " << y << " at " << frame.time;
      ASSERT_TRUE(x > 0 && y > 0 && x < scene.domain.max[0] && y < scene.domain.max[1]);
      const bool stayed = (x < kGate) == (first.position[3 * i] < kGate);
      ASSERT_TRUE(stayed || frame.time > kEquilibrium);
      // Grains stay above the filter.
      ASSERT_TRUE(frame.phase[i] == 1 || scene.bodies[frame.body[i]].fixed || y > 0.06);
    }
}

/// What the tank's level says it lost is what went through the gate.
void expect_levels_follow_the_flow(const Scene& scene, const Recorded& r) {
  const double spacing = scene.cell_size() / scene.numerics.points_per_cell, share = spacing * spacing;
  double worst = 0;
  for (const Frame& frame : r.results.frames) {
    double level = 0, volume = 0;
    for (std::size_t i = 0; i < frame.points(); ++i) {
      if (frame.phase[i] != 1 || frame.position[3 * i] > kGate) continue;
      const int body = frame.body[i];
      volume += share * (scene.bodies[body].kind == BodyKind::water ? 1 : 0.4);
      level = std::max(level, frame.position[3 * i + 1] + 0.5 * spacing);
    }
    const double by_level = kBlockLeft * level + (kGate - kBlockLeft) * kBlockLow;
    worst = std::max(worst, std::abs(by_level - volume));
  }
  std::printf("tank's level against the flow: %.2e of all water\n",
              worst / r.report.ledger.water_volume_initial);
  EXPECT_LT(worst, 0.005 * r.report.ledger.water_volume_initial);
}

/// What holds in every run under the full head.
void expect_sound_run(const Scene& scene, const Recorded& r) {
  expect_equilibrium(scene, r, 0.46);
  expect_conservation(r);
  expect_no_leak(scene, r);
  expect_levels_follow_the_flow(scene, r);
}

/// The layer has risen and left a gap: away from the walls no grain lies within `gap` above the filter.
void expect_heave(const Recorded& r, double least_rise, double gap) {
  ASSERT_EQ(r.report.heave.size(), 1u);
  const HeaveReport& heave = r.report.heave[0];
  std::printf("moved at %.3f s, gradient until then %.2f, rise %.1f mm\n", heave.time, heave.gradient,
              1e3 * heave.final_rise);
  EXPECT_TRUE(heave.moved);
  EXPECT_GT(heave.gradient, 0.9);
  EXPECT_GT(heave.final_rise, least_rise);
  const Frame& last = r.results.frames.back();
  double lowest = 1;
  for (std::size_t i = 0; i < last.points(); ++i) {
    const double x = last.position[3 * i], y = last.position[3 * i + 1];
    if (last.phase[i] == 0 && y > kFilterTop && std::abs(x - 0.30) < 0.03) lowest = std::min(lowest, y);
  }
  EXPECT_GT(lowest, kFilterTop + gap);
}

/// Grains have loosened somewhere within 3 cm of the layer's surface.
void expect_loosened_surface(const Recorded& r) {
  const Frame& last = r.results.frames.back();
  const auto& n = field(last, "porosity");
  double top = 0, loosest = 0;
  for (std::size_t i = 0; i < last.points(); ++i)
    if (last.phase[i] == 0) top = std::max(top, last.position[3 * i + 1]);
  for (std::size_t i = 0; i < last.points(); ++i)
    if (last.phase[i] == 0 && last.position[3 * i + 1] > top - 0.03)
      loosest = std::max<double>(loosest, n[i]);
  std::printf("loosest grains near the surface: n = %.3f\n", loosest);
  EXPECT_GT(loosest, 0.45);
}

TEST(Heave, EquilibriumThenTheGapOpens) {
  const Scene scene = shortened("heave", 0.5);
  const Recorded r = record(scene);
  expect_sound_run(scene, r);
  expect_heave(r, 0.0015, 0.004);
}

/// Without wall friction the layer lifts as one plug as soon as the gradient passes i_c.
TEST(Heave, SmoothWallsLetItRiseAsAPlug) {
  const Scene scene = shortened("heave-smooth-walls", 0.5);
  const Recorded r = record(scene);
  expect_sound_run(scene, r);
  expect_heave(r, 0.01, 0.005);
}

TEST(Heave, HalfTheCriticalHeadMovesNothing) {
  const Scene scene = shortened("heave-low-head", 0.5);
  const Recorded r = record(scene);
  expect_equilibrium(scene, r, 0.28);
  expect_conservation(r);
  EXPECT_FALSE(r.report.heave[0].moved);
  EXPECT_LT(r.report.heave[0].max_point_displacement, 5e-4);
}

/// Every bit of every frame and series, for any number of threads.
TEST(Heave, ThreadsDoNotChangeABit) {
  const Scene scene = shortened("heave", 0.1);
  const Recorded one = record(scene, 1), two = record(scene, 2);
  ASSERT_EQ(one.results.frames.size(), two.results.frames.size());
  EXPECT_EQ(one.results.times, two.results.times);
  EXPECT_EQ(one.results.series("ledger.energy"), two.results.series("ledger.energy"));
  for (std::size_t k = 0; k < one.results.frames.size(); ++k) {
    const Frame &a = one.results.frames[k], &b = two.results.frames[k];
    EXPECT_EQ(a.position, b.position) << "frame " << k;
    ASSERT_EQ(a.fields.size(), b.fields.size());
    for (std::size_t f = 0; f < a.fields.size(); ++f)
      EXPECT_EQ(a.fields[f].values, b.fields[f].values) << a.fields[f].name;
  }
}

/// The paper's reduced bulk modulus gives the same story.
TEST(Heave, ReducedBulkModulusRisesAlike) {
  const Recorded real = record(shortened("heave", 0.3)),
                 reduced = record(shortened("heave-reduced-bulk-modulus", 0.3));
  EXPECT_NEAR(reduced.report.heave[0].final_rise, real.report.heave[0].final_rise,
              0.05 * real.report.heave[0].final_rise);
}

TEST(SlowHeave, DraftToTheEnd) {
  const Scene scene = load("heave", Preset::draft);
  const Recorded r = record(scene);
  expect_sound_run(scene, r);
  expect_heave(r, 0.015, 0.01);
  expect_loosened_surface(r);
}

TEST(SlowHeave, LowHeadForFiveSeconds) {
  for (const Preset preset : {Preset::draft, Preset::standard}) {
    const Scene scene = load("heave-low-head", preset);
    const Recorded r = record(scene);
    expect_equilibrium(scene, r, 0.28);
    expect_conservation(r);
    EXPECT_FALSE(r.report.heave[0].moved);
    EXPECT_LT(r.report.heave[0].max_point_displacement, 5e-4);
  }
}

TEST(SlowHeave, StandardTellsTheSameStory) {
  const Scene scene = load("heave", Preset::standard);
  const Recorded r = record(scene), draft = record(load("heave", Preset::draft));
  expect_sound_run(scene, r);
  expect_heave(r, 0.015, 0.01);
  expect_loosened_surface(r);
  // Rough walls hold the sand within half a cell of them, so the coarse grid is held more: 20 % less rise.
  EXPECT_NEAR(r.report.heave[0].time, draft.report.heave[0].time, 0.1);
  EXPECT_NEAR(r.report.heave[0].final_rise, draft.report.heave[0].final_rise,
              0.35 * draft.report.heave[0].final_rise);
}

}  // namespace
}  // namespace quicksand::test

#include "engine/study/tradeoff.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "engine/scene/check.hpp"
#include "tests/engine/small_scene.hpp"

namespace quicksand {
namespace {

/// 8 by 12 cells of saturated elastic soil that settles under its own weight, watched by a probe.
Scene column() {
  Scene scene = test::plane(0.08, 0.16, 0.01, 0.01);
  test::add_body(scene, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.08, 0.12, 0});
  scene.soils.at("sand").model.law = SoilLaw::linear_elastic;
  scene.output.series_interval = 0.002;
  scene.output.probes = {{"base", {0.04, 0.015, 0}, "pore_pressure"}};
  return scene;
}

const Rung* find(const std::vector<Rung>& rungs, const std::string& factor, const std::string& setting = "") {
  const auto found = std::find_if(rungs.begin(), rungs.end(), [&](const Rung& rung) {
    return rung.factor == factor && (setting.empty() || rung.setting == setting);
  });
  return found == rungs.end() ? nullptr : &*found;
}

TEST(Ladder, ChangesOneFactorAtATimeAndOnlyWhatFits) {
  const Scene scene = column();
  const std::vector<Rung> rungs = ladder(scene);
  EXPECT_EQ(rungs.front().factor, "as given");
  std::set<std::string> factors, all;
  for (const Rung& rung : rungs) {
    EXPECT_TRUE(check(rung.scene).empty()) << rung.factor << ' ' << rung.setting;
    EXPECT_TRUE(all.insert(rung.factor + " " + rung.setting).second) << rung.factor << ' ' << rung.setting;
    factors.insert(rung.factor);
    const bool cells = rung.factor == "cell size" || rung.factor == "as given";
    if (!cells) {
      EXPECT_EQ(rung.scene.cell_size(), scene.cell_size()) << rung.factor;
    }
    EXPECT_EQ(rung.scene.output.probes.size(), 1u);
  }
  EXPECT_EQ(factors,
            (std::set<std::string>{"as given", "cell size", "points per cell", "kernel", "transfer",
                                   "time step", "pressure tolerance", "pressure", "water bulk modulus"}));
  EXPECT_TRUE(find(rungs, "cell size", "0.04 m") && find(rungs, "cell size", "0.02 m"));
  EXPECT_TRUE(find(rungs, "cell size", "0.005 m") && find(rungs, "cell size", "0.0025 m"));
  EXPECT_FALSE(find(rungs, "cell size", "0.03 m"));  // 0.08 m are no whole number of them
  EXPECT_EQ(find(rungs, "kernel")->scene.numerics.kernel, Kernel::linear);
  EXPECT_EQ(find(rungs, "pressure")->scene.numerics.pressure, PressureScheme::explicit_scheme);
}

TEST(Ladder, LeavesOutWhatASceneDoesNotHave) {
  Scene dry = test::plane(0.08, 0.16, 0.01, 0.01);
  test::add_body(dry, "bed", BodyKind::soil, {0, 0, 0}, {0.08, 0.12, 0});
  for (const char* factor : {"pressure", "pressure tolerance", "water bulk modulus"})
    EXPECT_FALSE(find(ladder(dry), factor)) << factor;
  Scene stiff = column();
  stiff.water.bulk_modulus.reset();
  EXPECT_FALSE(find(ladder(stiff), "pressure"));
  EXPECT_FALSE(find(ladder(stiff), "water bulk modulus"));
  Scene explicitly = column();
  explicitly.numerics.pressure = PressureScheme::explicit_scheme;
  EXPECT_EQ(find(ladder(explicitly), "pressure")->setting, "implicit");
  EXPECT_FALSE(find(ladder(explicitly), "pressure tolerance"));
}

TEST(ErrorAgainst, IsOfTheLargestRangeOfItsKind) {
  const std::vector<double> time{0, 1};
  const Curve up{"probe.v", "m/s", 1, time, {0, 10}}, aside{"probe.v", "m/s", 0, time, {0, 1e-15}},
      pressure{"probe.p", "Pa", 0, time, {0, 100}};
  EXPECT_EQ(error_against({up, aside, pressure}, {up, aside, pressure}), 0);
  Curve noisy = aside;
  noisy.value = {0, 2e-14};  // twenty times its own range, nothing of the other component's
  EXPECT_LT(error_against({up, noisy, pressure}, {up, aside, pressure}), 1e-14);
  Curve off = pressure;
  off.value = {10, 110};
  EXPECT_DOUBLE_EQ(error_against({up, aside, off}, {up, aside, pressure}), 0.1);
}

RungResult rung(double error, double seconds) {
  RungResult r;
  r.factor = "cell size";
  r.setting = std::to_string(error);
  r.error = error, r.cpu_seconds = seconds, r.steps = 10, r.point_steps = 1000, r.memory_bytes = 1e6;
  return r;
}

std::vector<bool> front_of(std::vector<RungResult> rungs) {
  mark_front(rungs);
  std::vector<bool> on;
  for (const RungResult& r : rungs) on.push_back(r.on_front);
  return on;
}

TEST(Front, HoldsWhatNothingCheaperBeats) {
  EXPECT_EQ(front_of({rung(0.1, 1), rung(0.05, 8), rung(0.2, 2), rung(0.01, 60)}),
            (std::vector<bool>{true, true, false, true}));
}

TEST(Front, IsNotMadeOfNoise) {
  // The same error, the timer's jitter; a little better for no more time.
  EXPECT_EQ(front_of({rung(0.1, 1), rung(0.0999, 1.02), rung(0.08, 1.04), rung(0.0799, 1.03)}),
            (std::vector<bool>{false, false, false, true}));
}

TEST(Front, LeavesOutTheReferenceAndWhatDidNotRun) {
  RungResult reference = rung(0, 100), missing = rung(0, 0);
  reference.reference = true;
  missing.missing = "failed: diverged";
  EXPECT_EQ(front_of({rung(0.1, 1), reference, missing}), (std::vector<bool>{true, false, false}));
}

Tradeoff some() {
  Tradeoff tradeoff;
  tradeoff.reference = "the run with cells of 0.01 m";
  tradeoff.rungs = {rung(0.1, 1), rung(0.05, 8), rung(0.2, 2), rung(0, 64), rung(0, 0)};
  tradeoff.rungs[3].reference = true;
  tradeoff.rungs[4].missing = "not run: over the budget";
  mark_front(tradeoff.rungs);
  return tradeoff;
}

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == by)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

TEST(TradeoffCsv, HasARowPerRung) {
  const auto rows = split(tradeoff_csv(some()), '\n');
  ASSERT_EQ(rows.size(), 7u);  // header, five rungs, the end of the last line
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(split(rows[k], ',').size(), 9u) << rows[k];
  EXPECT_EQ(rows[0], "factor,setting,error,cpu_seconds,memory_bytes,steps,point_steps,front,note");
  EXPECT_EQ(rows[1], "cell size,0.100000,0.1,1,1e+06,10,1000,1,");
  EXPECT_EQ(split(rows[4], ',')[2], "");  // the reference has no error against itself
  EXPECT_EQ(split(rows[4], ',')[8], "reference");
  EXPECT_EQ(split(rows[5], ',')[8], "not run: over the budget");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(TradeoffPicture, ShowsEveryRungThatHasAnError) {
  const std::string svg = tradeoff_svg(some(), "a <b> & c");
  EXPECT_EQ(count(svg, "<circle"), 3u);
  EXPECT_EQ(count(svg, "<polyline"), 1u);
  EXPECT_NE(svg.find("a &lt;b&gt; &amp; c"), std::string::npos);
  EXPECT_NE(svg.find("not run: over the budget"), std::string::npos);
  EXPECT_EQ(count(svg, "<text"), count(svg, "</text>"));
  EXPECT_TRUE(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
}

TEST(TradeoffPicture, IsDrawnWithoutAnyErrorToo) {
  Tradeoff nothing;
  nothing.reference = "nothing";
  EXPECT_EQ(count(tradeoff_svg(nothing, "none"), "<circle"), 0u);
}

TEST(TradeoffPicture, ComesAsPngOfTheSameSize) {
  const std::string png = tradeoff_png(some(), "a");
  ASSERT_GT(png.size(), 1000u);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  const auto number = [&](std::size_t at) {
    return static_cast<unsigned char>(png[at + 2]) * 256 + static_cast<unsigned char>(png[at + 3]);
  };
  const std::string svg = tradeoff_svg(some(), "a");
  EXPECT_NE(svg.find("width=\"" + std::to_string(number(16)) + "\""), std::string::npos);
  EXPECT_NE(svg.find("height=\"" + std::to_string(number(20)) + "\""), std::string::npos);
  EXPECT_NE(tradeoff_png(Tradeoff{}, "a"), png);
}

class Watching final : public RunMonitor {
 public:
  void progress(const Progress& now) override {
    EXPECT_GE(now.fraction, last_ - 1e-12);
    EXPECT_LE(now.fraction, 1 + 1e-9);
    last_ = now.fraction;
    stages.insert(now.stage);
  }
  bool cancelled() override { return stages.size() >= cancel_at; }
  bool suspended() override { return stages.size() >= suspend_at; }
  std::set<std::string> stages;
  std::size_t cancel_at = 1000, suspend_at = 1000;

 private:
  double last_ = 0;
};

TEST(Tradeoff, MeasuresTheLadderAgainstItsFinestRun) {
  Watching monitor;
  Scene scene = column();
  scene.domain.cell_size = 0.02;
  scene.stages[0].duration = 0.002;
  scene.output.series_interval = 0.001;
  const Tradeoff tradeoff = measure_tradeoff(scene, {}, 1, 0, monitor);
  EXPECT_EQ(tradeoff.status, RunStatus::succeeded);
  ASSERT_EQ(tradeoff.rungs.size(), ladder(scene).size());
  EXPECT_EQ(tradeoff.reference, "the run with cells of 0.005 m");
  std::size_t references = 0, run = 0;
  for (const RungResult& r : tradeoff.rungs) {
    references += r.reference;
    EXPECT_GT(r.memory_bytes, 0);
    if (!r.missing.empty()) continue;
    ++run;
    EXPECT_TRUE(r.reference ? r.error == 0 : r.error > 0) << r.factor;
    EXPECT_GT(r.steps, 0);
    EXPECT_GT(r.point_steps, r.steps);
    EXPECT_GT(r.cpu_seconds, 0);
  }
  EXPECT_EQ(references, 1u);
  EXPECT_EQ(run, tradeoff.rungs.size());
  EXPECT_TRUE(monitor.stages.contains("1 of " + std::to_string(tradeoff.rungs.size()) + ": as given 0.02 m"));
}

TEST(Tradeoff, UsesTheCurvesGiven) {
  Watching monitor;
  Scene scene = column();
  scene.stages[0].duration = 0.002;
  scene.domain.cell_size = 0.02;
  const Curve base{"probe.base", "Pa", 0, {0, 0.002}, {1e6, 1e6}};
  const Tradeoff tradeoff = measure_tradeoff(scene, {base}, 1, 0, monitor);
  EXPECT_EQ(tradeoff.reference, "the curves given");
  const RungResult& own = tradeoff.rungs.front();
  EXPECT_NEAR(own.error, 1, 0.01);  // some kPa of the MPa said
  for (const RungResult& r : tradeoff.rungs) EXPECT_FALSE(r.reference);
}

TEST(Tradeoff, SaysWhenThereIsNothingToCompare) {
  Scene still = test::plane(0.08, 0.16, 0.02, 0.001);
  test::add_body(still, "pond", BodyKind::water, {0, 0, 0}, {0.08, 0.12, 0});
  RunMonitor monitor;
  for (const RungResult& r : measure_tradeoff(still, {}, 1, 0, monitor).rungs) {
    EXPECT_EQ(r.missing, "nothing to compare: give a probe") << r.factor;
    EXPECT_FALSE(r.on_front);
  }
}

TEST(Tradeoff, EndsWhenItIsCancelledOrSuspended) {
  Watching cancels, suspends;
  cancels.cancel_at = suspends.suspend_at = 2;
  const Tradeoff cancelled = measure_tradeoff(column(), {}, 1, 0, cancels);
  EXPECT_EQ(cancelled.status, RunStatus::canceled);
  EXPECT_LE(cancelled.rungs.size(), 2u);
  EXPECT_EQ(measure_tradeoff(column(), {}, 1, 0, suspends).status, RunStatus::suspended);
}

TEST(TradeoffCost, IsNoMoreThanTheBudget) {
  const TradeoffCost all = tradeoff_cost(column(), 0), some = tradeoff_cost(column(), all.seconds / 4);
  EXPECT_GT(all.seconds, 0);
  EXPECT_LE(some.seconds, all.seconds / 2);
  EXPECT_LE(some.memory_bytes, all.memory_bytes);
}

TEST(CurvesFromCsv, ReadsNamesComponentsAndNumbers) {
  const auto curves = curves_from_csv("time,probe.base,probe.speed[1]\n0,1,2\n0.5,3,4e-2\n");
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[0].name, "probe.base");
  EXPECT_EQ(curves[1].name, "probe.speed");
  EXPECT_EQ(curves[1].component, 1);
  EXPECT_EQ(curves[1].value, (std::vector<double>{2, 0.04}));
}

TEST(CurvesFromCsv, NamesTheLineThatIsNone) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      curves_from_csv(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("t,a\n0,1\n").find("line 1"), std::string::npos);
  EXPECT_NE(refusal("time,a\n0,1\n1,x\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("time,a\n0,1,2\n").find("line 2"), std::string::npos);
  EXPECT_NE(refusal("time,a\n"), "");
  EXPECT_NE(refusal(""), "");
}

}  // namespace
}  // namespace quicksand

// The run as its callers see it: frames, series, stages, cancellation.

#include "engine/run/run.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <thread>

#include "tests/engine/small_scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand {
namespace {

using test::add_body;
using test::plane;

Scene pool(double duration) {
  Scene s = plane(1, 1, 0.1, duration);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {1, 0.5, 0});
  s.output.frame_interval = 0.05;
  s.output.series_interval = 0.01;
  return s;
}

Scene bed(double duration) {
  Scene s = plane(0.6, 0.8, 0.1, duration);
  add_body(s, "bed", BodyKind::saturated_soil, {0, 0, 0}, {0.6, 0.3, 0});
  add_body(s, "above", BodyKind::water, {0, 0.3, 0}, {0.6, 0.5, 0});
  s.output.frame_interval = 0.005;
  s.output.series_interval = 0.001;
  return s;
}

TEST(Run, FramesComeAtTheirTimes) {
  const auto r = test::record(pool(0.23));
  ASSERT_EQ(r.report.status, RunStatus::succeeded) << r.report.failure.message;
  const double times[] = {0, 0.05, 0.1, 0.15, 0.2, 0.23};  // and at the end
  ASSERT_EQ(r.results.frames.size(), 6u);
  EXPECT_EQ(r.report.frames, 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(r.results.frames[i].time, times[i], 1e-12);
    EXPECT_EQ(r.results.frames[i].index, i);
    EXPECT_EQ(r.results.frames[i].stage, "only");
  }
  EXPECT_NEAR(r.report.sim_time, 0.23, 1e-12);
}

TEST(Run, SamplesComeAtTheirTimes) {
  const auto r = test::record(pool(0.2));
  ASSERT_EQ(r.results.times.size(), 21u);
  for (std::size_t i = 0; i < 21; ++i) EXPECT_NEAR(r.results.times[i], 0.01 * static_cast<double>(i), 1e-12);
}

TEST(Run, IntervalsThatDoNotDivideEachOther) {
  Scene s = pool(0.1);
  s.output.frame_interval = 0.03;
  s.output.series_interval = 0.007;
  const auto r = test::record(s);
  ASSERT_EQ(r.results.frames.size(), 5u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(r.results.frames[i].time, 0.03 * static_cast<double>(i), 1e-12);
  ASSERT_EQ(r.results.times.size(), 16u);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_NEAR(r.results.times[i], 0.007 * static_cast<double>(i), 1e-12);
  EXPECT_NEAR(r.results.times.back(), 0.1, 1e-12);  // the end is sampled as well
}

/// Counts what the sink is given against what `begin` announced.
struct Counter : ResultSink {
  std::size_t width = 0, begun = 0, samples = 0;
  double last = -1;
  void begin(const std::vector<SeriesInfo>& series) override {
    ++begun;
    for (const SeriesInfo& s : series) width += s.components;
  }
  void frame(Frame f) override {
    EXPECT_EQ(begun, 1u);
    EXPECT_EQ(f.position.size(), 3 * f.points());
    EXPECT_EQ(f.body.size(), f.points());
    for (const FrameField& field : f.fields) EXPECT_EQ(field.values.size(), field.components * f.points());
  }
  void sample(double time, const std::vector<double>& values) override {
    EXPECT_GT(time, last);
    EXPECT_EQ(values.size(), width);
    last = time;
    ++samples;
  }
};

TEST(Run, SeriesAreAsManyAsAnnounced) {
  Scene s = bed(0.01);
  s.output.probes = {{"p", {0.3, 0.1, 0}, "pore_pressure"},
                     {"v", {0.3, 0.1, 0}, "water_velocity"},
                     {"h", {0.3, 0.1, 0}, "head"},
                     {"n", {0.3, 0.1, 0}, "porosity"},
                     {"s", {0.3, 0.1, 0}, "soil_velocity"}};
  Counter counter;
  RunMonitor monitor;
  ASSERT_EQ(run(s, counter, monitor).status, RunStatus::succeeded);
  EXPECT_EQ(counter.samples, 11u);
  EXPECT_GT(counter.width, 5u + 4);
}

TEST(Run, ProbesShowStillWater) {
  Scene s = bed(0.01);
  s.output.probes = {{"p", {0.3, 0.12, 0}, "pore_pressure"},
                     {"h", {0.3, 0.37, 0}, "head"},
                     {"n", {0.3, 0.1, 0}, "porosity"}};
  const auto r = test::record(s);
  EXPECT_NEAR(r.results.series("probe.p").front(), 9810 * 0.38, 1);
  EXPECT_NEAR(r.results.series("probe.h").front(), 0.5, 1e-4);
  EXPECT_NEAR(r.results.last("probe.n"), 0.4, 1e-3);
  EXPECT_NEAR(r.results.last("ledger.water_mass"), 1000 * 0.6 * (0.4 * 0.3 + 0.2), 1e-9);
  EXPECT_NEAR(r.results.last("ledger.water_volume"), 0.6 * (0.4 * 0.3 + 0.2), 1e-4);
  EXPECT_NEAR(r.results.last("ledger.solid_mass"), 2650 * 0.6 * 0.6 * 0.3, 1e-9);
}

TEST(Run, OnlyTheFieldsAskedFor) {
  Scene s = pool(0.01);
  s.output.fields = {"velocity", "pore_pressure"};
  const auto r = test::record(s);
  ASSERT_EQ(r.results.frames.front().fields.size(), 2u);
  EXPECT_EQ(r.results.frames.front().fields[0].name, "velocity");
  EXPECT_EQ(r.results.frames.front().fields[1].name, "pore_pressure");
  EXPECT_EQ(test::record(pool(0.01)).results.frames.front().fields.size(), 7u);
}

TEST(Run, UntilRestEndsTheStageEarlyAndTheNextFollows) {
  Scene s = pool(100);
  s.stages[0].until_rest = UntilRest{1e-4, 1.5};
  Stage after;
  after.name = "after", after.duration = 0.03;
  s.stages.push_back(after);
  const auto r = test::record(s);
  ASSERT_EQ(r.report.status, RunStatus::succeeded);
  EXPECT_GE(r.report.sim_time, 1.53 - 1e-9);  // not before `at_least`
  EXPECT_LT(r.report.sim_time, 3);
  EXPECT_EQ(r.results.frames.front().stage, "only");
  EXPECT_EQ(r.results.frames.back().stage, "after");
}

TEST(Run, UntilRestLastsItsDurationWhileThingsMove) {
  Scene s = plane(1, 1, 0.1, 0.08);
  add_body(s, "drop", BodyKind::water, {0.3, 0.5, 0}, {0.7, 0.8, 0});
  s.stages[0].until_rest = UntilRest{1e-4, 0};
  const auto r = test::record(s);
  EXPECT_NEAR(r.report.sim_time, 0.08, 1e-12);
}

TEST(Run, AGateThatAStageOpensLetsTheWaterOut) {
  Scene s = plane(1, 1, 0.1, 0.1);
  add_body(s, "pool", BodyKind::water, {0, 0, 0}, {0.5, 0.8, 0});
  s.gates = {{"gate", {{0.5, 0, 0}, {0.5, 1, 0}}}};
  Stage open = s.stages[0];
  open.name = "open", open.open_gates = {"gate"};
  s.stages.push_back(open);
  s.output.frame_interval = 0.1;
  const auto r = test::record(s);
  const auto furthest = [&](std::size_t k) {
    double x = 0;
    for (std::size_t p = 0; p < r.results.frames[k].points(); ++p)
      x = std::max(x, r.results.frames[k].position[3 * p]);
    return x;
  };
  ASSERT_EQ(r.results.frames.size(), 3u);
  EXPECT_LT(furthest(1), 0.5);
  EXPECT_GT(furthest(2), 0.52);
}

struct Canceller : RunMonitor {
  long after, steps = 0;
  explicit Canceller(long n) : after(n) {}
  void progress(const Progress& p) override { steps = p.step; }
  bool cancelled() override { return steps >= after; }
};

TEST(Run, CancellationTakesEffectWithinAStep) {
  for (const long after : {0L, 1L, 7L}) {
    test::Recorder sink;
    Canceller monitor(after);
    const RunReport report = run(pool(1), sink, monitor);
    EXPECT_EQ(report.status, RunStatus::canceled);
    EXPECT_EQ(report.steps, after);
    EXPECT_LT(report.sim_time, 1);
    ASSERT_FALSE(sink.frames.empty());
    EXPECT_EQ(sink.frames.back().time, report.sim_time);  // the last state is kept
  }
}

TEST(Run, ProgressGoesFromZeroToOne) {
  struct Watcher : RunMonitor {
    std::vector<Progress> seen;
    void progress(const Progress& p) override { seen.push_back(p); }
  } monitor;
  test::Recorder sink;
  const RunReport report = run(pool(0.1), sink, monitor);
  ASSERT_EQ(static_cast<long>(monitor.seen.size()), report.steps);
  for (std::size_t i = 1; i < monitor.seen.size(); ++i) {
    EXPECT_GT(monitor.seen[i].fraction, monitor.seen[i - 1].fraction);
    EXPECT_EQ(monitor.seen[i].step, static_cast<long>(i) + 1);
  }
  EXPECT_EQ(monitor.seen.back().bound, "surface wave");
  EXPECT_NEAR(monitor.seen.back().fraction, 1, 1e-9);
}

TEST(Run, ReportAddsUp) {
  const auto r = test::record(bed(0.01));
  double bound = 0;
  for (const StepBound& b : r.report.steps_bound_by) bound += b.seconds;
  EXPECT_NEAR(bound, r.report.sim_time, 1e-12);
  EXPECT_LE(r.report.time_step_min, r.report.time_step_max);
  EXPECT_GT(r.report.time_step_min, 0);
  const double points = 18 * 4 * 2 + 12 * 4;
  EXPECT_EQ(r.report.point_steps, points * static_cast<double>(r.report.steps));
  EXPECT_EQ(r.report.ledger.water_mass, r.report.ledger.water_mass_initial);
  EXPECT_EQ(r.report.ledger.solid_mass, r.report.ledger.solid_mass_initial);
}

TEST(Run, PhasesTellWhereTheTimeWent) {
  using std::chrono::milliseconds;
  struct Slow : Counter {
    void frame(Frame f) override { std::this_thread::sleep_for(milliseconds(20)), Counter::frame(f); }
    void sample(double time, const std::vector<double>& values) override {
      std::this_thread::sleep_for(milliseconds(5)), Counter::sample(time, values);
    }
  } sink;
  RunMonitor monitor;
  const RunReport report = run(bed(0.01), sink, monitor);
  ASSERT_EQ(report.status, RunStatus::succeeded);
  double all = 0;
  std::map<std::string, double> seconds;
  for (const PhaseTime& phase : report.phases) seconds[phase.name] = phase.seconds, all += phase.seconds;
  EXPECT_EQ(seconds.size(), 6u);
  for (const auto& [name, s] : seconds) EXPECT_GT(s, 0) << name;
  const double slept = 0.02 * static_cast<double>(report.frames) + 0.005 * static_cast<double>(sink.samples);
  EXPECT_GE(report.wall_seconds, slept);  // a run ends when all is written
  EXPECT_LE(all, report.wall_seconds);
}

TEST(Run, ThreadsNeverChangeTheResult) {
  Scene s = plane(1, 0.8, 0.05, 0.02);
  add_body(s, "bank", BodyKind::saturated_soil, {0, 0, 0}, {0.4, 0.4, 0});
  add_body(s, "pool", BodyKind::water, {0.4, 0, 0}, {0.7, 0.6, 0});
  const auto one = test::record(s, 1), two = test::record(s, 2);
  ASSERT_EQ(one.results.frames.size(), two.results.frames.size());
  EXPECT_EQ(one.results.frames.back().position, two.results.frames.back().position);
  EXPECT_EQ(one.results.series("max_speed"), two.results.series("max_speed"));
}

TEST(Run, ProbesOnFacesOfBlocksSeeTheWaterBesideThem) {
  Scene s = test::plane(0.8, 0.6, 0.05, 1e-3);
  Wall sill;
  sill.name = "sill";
  sill.block = test::box({0.3, 0, 0}, {0.5, 0.2, 0});
  s.walls = {sill};
  add_body(s, "left", BodyKind::water, {0, 0, 0}, {0.3, 0.5, 0});
  add_body(s, "middle", BodyKind::water, {0.3, 0.2, 0}, {0.5, 0.5, 0});
  add_body(s, "right", BodyKind::water, {0.5, 0, 0}, {0.8, 0.5, 0});
  s.output.probes = {{"left", {0.3, 0.1, 0}, "pore_pressure"},
                     {"right", {0.5, 0.1, 0}, "pore_pressure"},
                     {"top", {0.4, 0.2, 0}, "pore_pressure"},
                     {"corner", {0.3, 0, 0}, "pore_pressure"}};
  const auto r = test::record(s);
  EXPECT_NEAR(r.results.series("probe.left").front(), 9810 * 0.4, 1);
  EXPECT_NEAR(r.results.series("probe.right").front(), 9810 * 0.4, 1);
  EXPECT_NEAR(r.results.series("probe.top").front(), 9810 * 0.3, 1);
  EXPECT_NEAR(r.results.series("probe.corner").front(), 9810 * 0.5, 1);
}

}  // namespace
}  // namespace quicksand

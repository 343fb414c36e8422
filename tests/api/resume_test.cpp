// A run that was saved and goes on elsewhere gives the same bits as one that was never disturbed: every
// shipped case, so that everything a scene can hold is among what is saved.

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/api/heave_case.hpp"
#include "tests/verification/dimensions.hpp"

namespace quicksand {
namespace {

/// What reached the sink, as bytes.
class Recorder final : public ResultSink {
 public:
  void begin(const std::vector<SeriesInfo>&) override {}
  void frame(Frame frame) override {
    std::string bytes;
    const auto add = [&](const auto& list) {
      bytes.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(list[0]));
    };
    add(frame.position), add(frame.phase), add(frame.body), add(frame.stage);
    for (const FrameField& field : frame.fields) add(field.values);
    bytes.append(reinterpret_cast<const char*>(&frame.time), sizeof frame.time);
    frames.push_back(bytes);
  }
  void sample(double time, const std::vector<double>& values) override {
    std::vector<double> row = values;
    row.push_back(time);
    samples.push_back(row);
  }
  void checkpoint(const Checkpoint& made) override { last = made; }

  std::vector<std::string> frames;
  std::vector<std::vector<double>> samples;
  Checkpoint last;
};

/// Suspends after some steps, cancels after others.
struct Stopper final : RunMonitor {
  long suspend = -1, cancel = -1, steps = 0;
  Stopper(long after, long end) : suspend(after), cancel(end) {}
  void progress(const Progress& now) override { steps = now.step; }
  bool suspended() override { return steps == suspend; }
  bool cancelled() override { return steps == cancel; }
};

constexpr long kSteps = 48;

/// Every step counts as good, so that it can be saved.
RunOptions each_step_good(int threads) {
  RunOptions options;
  options.threads = threads;
  options.good_every = 1;
  return options;
}

/// The scene with stages, frames and samples so short that a few steps see all of them.
Scene shortened(Scene scene) {
  Recorder ignored;
  Stopper one(-1, 1);
  const double dt = run(scene, ignored, one, {1}).time_step_max;
  for (Stage& stage : scene.stages) stage.duration = 13.4 * dt;
  scene.output.frame_interval = 7.3 * dt;
  scene.output.series_interval = 3.1 * dt;
  return scene;
}

bool same_samples(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

void expect_same_resumed(const Scene& given, const std::string& name) {
  const Scene scene = shortened(given);
  Recorder straight;
  Stopper end(-1, kSteps);
  const RunReport whole = run(scene, straight, end, {1});
  ASSERT_NE(whole.status, RunStatus::failed) << name << whole.failure.message;
  int resumed = 0;
  for (const long at : {3L, 14L, 30L}) {
    Recorder parts;
    Stopper first(at, -1), rest(-1, kSteps);
    RunReport report = run(scene, parts, first, each_step_good(1));
    if (report.status != RunStatus::suspended) continue;  // ended before
    ++resumed;
    EXPECT_EQ(report.steps, at) << name;
    EXPECT_EQ(parts.last.frames, parts.frames.size()) << name;
    EXPECT_EQ(parts.last.samples, parts.samples.size()) << name;
    const Checkpoint checkpoint = parts.last;
    RunOptions options{2};
    options.resume = &checkpoint;
    report = run(scene, parts, rest, options);
    EXPECT_EQ(report.steps, whole.steps) << name;
    EXPECT_EQ(report.sim_time, whole.sim_time) << name;
    EXPECT_EQ(report.ledger.momentum_residual, whole.ledger.momentum_residual) << name;
    EXPECT_EQ(parts.frames == straight.frames, true) << name << " saved after step " << at;
    ASSERT_EQ(parts.samples.size(), straight.samples.size()) << name;
    for (std::size_t i = 0; i < parts.samples.size(); ++i)
      ASSERT_TRUE(same_samples(parts.samples[i], straight.samples[i]))
          << name << " saved after step " << at << ", sample " << i;
  }
  EXPECT_GE(resumed, 1) << name;
}

Scene shipped_case(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  const ParsedCase parsed = parse_case(text.str(), Preset::draft);
  if (!parsed.scene) throw std::runtime_error(test::said(parsed.faults));
  return *parsed.scene;
}
Scene heave() { return shipped_case(std::filesystem::path(SHIPPED_CASES) / "heave/case.json"); }

TEST(Resume, EveryShippedCaseGoesOnBitForBit) {
  for (const auto& folder : std::filesystem::directory_iterator(SHIPPED_CASES))
    if (std::filesystem::exists(folder.path() / "case.json"))
      expect_same_resumed(shipped_case(folder.path() / "case.json"), folder.path().filename().string());
}

TEST(Resume, EverySchemeGoesOnBitForBit) {
  Scene scene = heave();
  scene.numerics.transfer = Transfer::apic;
  expect_same_resumed(scene, "apic");
  scene = heave();
  scene.numerics.kernel = Kernel::linear;
  expect_same_resumed(scene, "linear");
  scene = heave();
  scene.numerics.pressure = PressureScheme::explicit_scheme;
  expect_same_resumed(scene, "explicit");
  scene = heave();
  scene.domain.cell_size *= 2;
  expect_same_resumed(test::in_space(scene, 4 * scene.domain.cell_size), "space");
}

TEST(Resume, RefusesLessThanAState) {
  Recorder sink;
  Stopper stop(5, -1);
  const Scene scene = shortened(heave());
  run(scene, sink, stop, {1});  // saves the beginning of the stage
  RunOptions options{1};
  options.resume = &sink.last;
  Stopper end(-1, 6);
  sink.last.state.resize(sink.last.state.size() / 2);
  EXPECT_EQ(run(scene, sink, end, options).status, RunStatus::failed);
}

}  // namespace
}  // namespace quicksand

// What the presets state: their cost against one another over all shipped cases, and that the draft's looser
// pressure is no part of its error. Their errors are held to by every page of the book (Page::error, near).

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "api/case_json.hpp"
#include "engine/plan/expected_error.hpp"
#include "engine/study/history.hpp"

namespace quicksand {
namespace {

std::optional<Scene> shipped(const std::string& name, Preset preset) {
  std::ifstream file(std::string(QUICKSAND_CASES) + "/" + name + "/case.json");
  std::stringstream text;
  text << file.rdbuf();
  return parse_case(text.str(), preset).scene;
}

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(QUICKSAND_CASES))
    if (std::filesystem::exists(entry.path() / "case.json"))
      names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

struct Step {
  double ratio;  ///< of points × steps
  bool by_wave;  ///< a wave that is advanced explicitly bounds the step
};

/// The next finer preset against this one; nothing where the case fixes its cells.
std::vector<Step> steps_to(Preset coarser, Preset finer) {
  std::vector<Step> all;
  for (const std::string& name : case_names()) {
    const auto a = shipped(name, coarser), b = shipped(name, finer);
    if (!a || !b || a->cell_size() == b->cell_size()) continue;
    const Plan p = make_plan(*a), q = make_plan(*b);
    const auto work = [](const Plan& plan) {
      return plan.steps * static_cast<double>(plan.soil_points + plan.fixed_soil_points + plan.water_points);
    };
    const double ratio = work(q) / work(p);
    all.push_back({ratio, p.bound.name == "soil wave" || p.bound.name == "water wave"});
    std::printf("%-28s %5.2f times, step bound by %s\n", name.c_str(), ratio, p.bound.name.c_str());
  }
  return all;
}

/// Four times the points; twice the steps where a wave bounds them, but for samples that must be met: 3 steps
/// between two for 2, the worst. Where nothing but the water's surface does, there are √2 times the steps, or
/// as many as samples.
void expect_costs(Preset coarser, Preset finer) {
  std::vector<double> by_wave;
  for (const Step& step : steps_to(coarser, finer)) {
    EXPECT_GE(step.ratio, step.by_wave ? 5.9 : 3.9);
    if (step.by_wave) by_wave.push_back(step.ratio);
  }
  ASSERT_GE(by_wave.size(), 20u);
  std::sort(by_wave.begin(), by_wave.end());
  EXPECT_GE(by_wave[by_wave.size() / 2], 7.9);
  EXPECT_GE(by_wave[1], 7.2);  // all but one
}

TEST(Presets, DraftIsEightTimesCheaperByTheWave) { expect_costs(Preset::draft, Preset::standard); }
TEST(Presets, StandardIsEightTimesCheaperByTheWave) { expect_costs(Preset::standard, Preset::fine); }

std::vector<Curve> curves_of(const Scene& scene) {
  HistorySink sink;
  RunMonitor monitor;
  EXPECT_EQ(run(scene, sink, monitor, {1}).status, RunStatus::succeeded);
  return sink.curves(2);
}

/// Pages run on the draft's cells with the standard tolerance; the preset's own is ten times looser.
TEST(Presets, TheDraftsPressureIsSolvedWellEnough) {
  for (const char* name : {"terzaghi", "self-weight", "unloading", "gravity-loading", "sheet-pile"}) {
    Scene draft = shipped(name, Preset::draft).value();
    draft.output.frame_interval = 1e9;
    Scene tight = draft;
    tight.numerics.pressure_tolerance = 1e-8;
    const std::vector<Curve> loose = curves_of(draft), truth = curves_of(tight);
    ASSERT_EQ(loose.size(), truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) {
      if (!truth[k].name.starts_with("probe.") || truth[k].unit == "m/s") continue;
      EXPECT_LE(distance(truth[k], loose[k]), 0.1 * expected_error(draft) * truth[k].range())
          << name << ' ' << truth[k].name;
    }
  }
}

}  // namespace
}  // namespace quicksand

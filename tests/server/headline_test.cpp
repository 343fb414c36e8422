#include "server/headline.hpp"

#include <gtest/gtest.h>

#include "api/case_json.hpp"

namespace quicksand {
namespace {

RunReport heaved() {
  RunReport report;
  report.heave.push_back({true, 3.42, 0.238, 1.98, 0.99, 0.012, 0.015, 0.031});
  report.ledger.water_volume_drift_max = 0.0012;
  report.sim_time = 5;
  report.wall_seconds = 40;
  report.steps = 10000;
  report.point_steps = 8e7;
  return report;
}

std::string headline(const RunReport& report) {
  Scene scene;
  scene.name = "heave";
  return headline_text(report_json(scene, Plan{}, report));
}

void expect_holds(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << " is missing in\n" << text;
}

TEST(HeadlineText, SaysWhenTheSandMovedAndUnderWhatGradient) {
  const std::string text = headline(heaved());
  for (const char* part : {"heave: succeeded", "moved at t = 3.42 s", "head difference until then 0.238 m",
                           "hydraulic gradient 1.98", "i_c 0.99", "12 mm at the end", "15 mm at most",
                           "31 mm", "0.12 %", "Simulated 5 s in 40 s", "10000 steps", "2e+06 point-steps/s"})
    expect_holds(text, part);
}

TEST(HeadlineText, SaysWhetherScaledInertiaMattered) {
  RunReport report;
  report.quasi_static = {{"settle", 2.5e7, 1e6, 5e3, 0.0003, true}, {"dig", 4, 10, 5, 0.2, false}};
  const std::string text = headline(report);
  for (const char* part :
       {"Stage settle: inertia × 2.5e+07", "0.03 % of the strain energy, inertia is negligible", "Stage dig",
        "20 % of the strain energy, INERTIA IS NOT NEGLIGIBLE"})
    expect_holds(text, part);
}

TEST(HeadlineText, SaysWhenItDidNotMove) {
  RunReport report = heaved();
  report.heave[0].moved = false;
  expect_holds(headline(report), "did not move");
}

TEST(HeadlineText, ARunWithoutSandHasNoHeave) {
  RunReport report = heaved();
  report.heave.clear();
  EXPECT_EQ(headline(report).find("sand"), std::string::npos);
}

TEST(HeadlineText, SurvivesNumbersThatAreNone) {
  RunReport report = heaved();
  report.status = RunStatus::failed;
  report.heave[0].gradient = 0.0 / 0.0;
  report.wall_seconds = 0;
  expect_holds(headline(report), "heave: failed");
}

TEST(HeadlineText, SurvivesATextThatIsNoReport) { expect_holds(headline_text("[1"), "cannot be read"); }

TEST(FilesText, NamesTheFileToOpen) {
  expect_holds(files_text("out/heave"), "out/heave/result.xdmf");
  expect_holds(files_text("out/heave"), "h5py.File('out/heave/result.vtkhdf')");
}

}  // namespace
}  // namespace quicksand

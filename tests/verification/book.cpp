#include "tests/verification/book.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>

#include "api/case_json.hpp"
#include "engine/plan/expected_error.hpp"

namespace quicksand::test {
namespace {

constexpr double kMassTolerance = 1e-12;  ///< –, relative

/// Mass that is there and that has left, against what was there and has come in.
double unbalanced(double now, double out, double before, double in) {
  const double all = before + in;
  return all > 0 ? std::abs(now + out - all) / all : 0;
}
double water_error(const Ledger& l) {
  return unbalanced(l.water_mass, l.water_out + l.water_removed, l.water_mass_initial, l.water_in);
}
double soil_error(const Ledger& l) {
  return unbalanced(l.solid_mass, l.soil_out + l.soil_removed, l.solid_mass_initial, 0);
}

nlohmann::json ledger_json(const Ledger& l) {
  return {{"mass_error", std::max(water_error(l), soil_error(l))},
          {"momentum_residual", l.momentum_residual},
          {"water_volume_drift", l.water_volume_drift_max},
          {"clipped_points", l.clipped_points},
          {"clamped_values", l.clamped_values},
          {"deleted_points", l.deleted_points},
          {"cut_steps", l.cut_steps},
          {"retries", l.retries}};
}

void expect_ledger(const RunReport& report, const LedgerLimits& limits) {
  const Ledger& l = report.ledger;
  EXPECT_EQ(report.status, RunStatus::succeeded) << report.failure.message;
  EXPECT_LE(water_error(l), kMassTolerance);
  EXPECT_LE(soil_error(l), kMassTolerance);
  EXPECT_LE(l.momentum_residual, limits.momentum_residual);
  EXPECT_LE(l.water_volume_drift_max, limits.water_volume_drift);
  EXPECT_EQ(l.deleted_points, 0);
  if (!limits.interventions) {
    EXPECT_EQ(l.clipped_points, 0);
    EXPECT_EQ(l.clamped_values, 0);
  }
}

/// Name of the test that runs, as ctest's -R takes it.
std::string current_test() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  return std::string(test->test_suite_name()) + "." + test->name();
}

std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

}  // namespace

Scene load_case(const std::string& name, double cell_size_factor) {
  std::ifstream file(std::string(QUICKSAND_CASES) + "/" + name + "/case.json");
  std::stringstream text;
  text << file.rdbuf();
  const ParsedCase parsed = parse_case(text.str(), Preset::standard);
  if (!parsed.scene)
    throw std::runtime_error(name + ": " + parsed.faults.front().pointer + " " +
                             parsed.faults.front().detail);
  Scene scene = *parsed.scene;
  scene.numerics.cell_size_factor *= cell_size_factor;
  return scene;
}

Page::Page(std::string case_name, std::string size) {
  page_ = {{"case", std::move(case_name)},
           {"size", std::move(size)},
           {"test", current_test()},
           {"runs", nlohmann::json::array()},
           {"figures", nlohmann::json::array()},
           {"curves", nlohmann::json::array()}};
}

Page::~Page() {
  const char* folder = std::getenv("QUICKSAND_BOOK");
  if (!folder || !*folder) return;
  const std::string name = page_["case"].get<std::string>() + "." + page_["test"].get<std::string>() + "." +
                           file_name(page_["size"].get<std::string>());
  std::ofstream(std::string(folder) + "/" + name + ".json") << page_.dump(1) << "\n";
}

Recorded Page::run(const Scene& scene, const LedgerLimits& limits, const std::string& label) {
  expected_ = std::max(expected_, expected_error(scene));
  const std::clock_t start = std::clock();
  Recorded r = record(scene);
  const double cpu = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  expect_ledger(r.report, limits);
  if (!page_.contains("name")) page_["name"] = scene.name;
  if (!page_.contains("cell_size")) page_["cell_size"] = scene.cell_size();
  page_["runs"].push_back({{"label", label},
                           {"cell_size", scene.cell_size()},
                           {"points", r.results.frames.empty() ? 0 : r.results.frames.front().points()},
                           {"steps", r.report.steps},
                           {"sim_seconds", r.report.sim_time},
                           {"cpu_seconds", cpu},
                           {"ledger", ledger_json(r.report.ledger)}});
  return r;
}

void Page::figure(nlohmann::json entry, double error, double asserted) {
  const std::string quantity = entry["quantity"], unit = entry["unit"];
  std::printf("%s, %s: %s = %.6g %s\n", page_["case"].get<std::string>().c_str(),
              page_["size"].get<std::string>().c_str(), quantity.c_str(), entry["value"].get<double>(),
              unit.c_str());
  EXPECT_LE(error, asserted) << quantity << " (" << unit << ")";
  page_["figures"].push_back(std::move(entry));
}

void Page::hold_to_the_preset(const std::string& quantity, double relative_error) const {
  if (expected_ == 0) return;  // a page without a run
  EXPECT_LE(relative_error, expected_) << quantity << ": more than is told of such cells before they are run";
}

void Page::error(const std::string& quantity, double value, double held_to, const std::string& unit) {
  const bool has_unit = unit == "m" || unit == "m/s" || unit == "Pa";
  if (!has_unit) hold_to_the_preset(quantity, value);
  figure({{"kind", "error"}, {"quantity", quantity}, {"value", value}, {"held_to", held_to}, {"unit", unit}},
         value, held_to);
}

void Page::missed_error(const std::string& quantity, double value, double held_to, double measured,
                        const std::string& unit) {
  figure({{"kind", "error"}, {"quantity", quantity}, {"value", value}, {"held_to", held_to}, {"unit", unit}},
         value, measured);
}

void Page::near(const std::string& quantity, double value, double reference, double tolerance,
                const std::string& unit) {
  if (reference != 0) hold_to_the_preset(quantity, std::abs(value / reference - 1));
  missed_near(quantity, value, reference, tolerance, tolerance, unit);
}

void Page::missed_near(const std::string& quantity, double value, double reference, double tolerance,
                       double measured, const std::string& unit) {
  figure({{"kind", "value"},
          {"quantity", quantity},
          {"value", value},
          {"reference", reference},
          {"held_to", tolerance},
          {"unit", unit}},
         std::abs(value - reference), measured * std::abs(reference));
}

void Page::value(const std::string& quantity, double value, const std::string& unit) {
  figure({{"kind", "note"}, {"quantity", quantity}, {"value", value}, {"unit", unit}}, 0, 0);
}

void Page::curve(const Curve& curve) {
  page_["curves"].push_back({{"title", curve.title},
                             {"x_label", curve.x_label},
                             {"y_label", curve.y_label},
                             {"label", curve.label},
                             {"x", curve.x},
                             {"result", curve.result},
                             {"reference", curve.reference},
                             {"reference_x", curve.reference_x}});
}

}  // namespace quicksand::test

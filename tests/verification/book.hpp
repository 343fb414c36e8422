#pragma once
// A page of the verification book: one case of cases/, run by one test at one size, with its figures, curves,
// cost and ledger. Figures are asserted as they are noted. If the environment variable QUICKSAND_BOOK names a
// folder, the page is written there as JSON, from which tests/verification/book makes tables and plots.
//
//   Page page("terzaghi", "20 cells");
//   const Recorded r = page.run(load_case("terzaghi", 1.0));
//   page.error("pressure", worst, 0.01, "of the load");
//   page.near("period", measured, 1.1818, 0.01, "s");
//   page.curve({.title = "…", .x_label = "T", .y_label = "p/q", .x = …, .result = …, .reference = …});

#include <nlohmann/json.hpp>

#include "tests/verification/recorder.hpp"

namespace quicksand::test {

/// The scene of cases/<name>/case.json as `quicksand run` reads it in standard size, its cells
/// `cell_size_factor` times as large. Throws with the first fault.
Scene load_case(const std::string& name, double cell_size_factor = 1);

/// `result` over `x`, beside what it should be over `reference_x` (x if empty). Curves of one title share
/// axes.
struct Curve {
  std::string title, x_label, y_label;
  std::string label;  ///< of the line; empty: the page's size
  std::vector<double> x, result;
  std::vector<double> reference{}, reference_x{};  ///< empty: none
};

/// What `Page::run` lets pass.
struct LedgerLimits {
  double momentum_residual = 1e-9;
  double water_volume_drift = 1e-3;
  bool interventions = false;  ///< clips and clamps may occur (splashes, loose grains); shown either way
};

class Page {
 public:
  /// `size` is how this page is told from others of the case: "20 cells", "k = 1e-6, 20 cells".
  Page(std::string case_name, std::string size);
  ~Page();
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  /// Runs, asserts what holds for every case (mass to 1e-12, momentum closed, no silent clips) and notes
  /// cost and ledger. `label` tells several runs of a page apart.
  Recorded run(const Scene& scene, const LedgerLimits& limits = {}, const std::string& label = "");

  /// An error ≥ 0, asserted to be at most `held_to`. Errors of one quantity over pages of different cell size
  /// give the order of convergence. One that has no unit is also held to what is told of such cells before
  /// they are run (engine/plan/expected_error.hpp), as are values by `near`.
  void error(const std::string& quantity, double value, double held_to, const std::string& unit);
  /// The same where the tolerance that the case is held to is not met, or was measured in an experiment:
  /// asserts `measured`, an honest bound, and nothing else.
  void missed_error(const std::string& quantity, double value, double held_to, double measured,
                    const std::string& unit);
  /// A value within `tolerance`·|reference| of its reference.
  void near(const std::string& quantity, double value, double reference, double tolerance,
            const std::string& unit);
  /// The same where the tolerance is not met: asserts the relative error `measured`.
  void missed_near(const std::string& quantity, double value, double reference, double tolerance,
                   double measured, const std::string& unit);
  /// A value worth knowing that nothing is held to.
  void value(const std::string& quantity, double value, const std::string& unit);
  void curve(const Curve& curve);

 private:
  void figure(nlohmann::json entry, double error, double asserted);
  void hold_to_the_preset(const std::string& quantity, double relative_error) const;
  nlohmann::json page_;
  double expected_ = 0;  ///< –, error that the runs so far were expected to have
};

}  // namespace quicksand::test

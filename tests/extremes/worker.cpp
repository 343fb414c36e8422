// Runs drawn scenes, one JSON line in, one out, through the public path: case text → parse_case → run. The
// line out says how the scene ended and every invariant that it broke. `run` starts it, and starts it again
// after a crash or a hang.

#include <tbb/global_control.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "api/case_json.hpp"
#include "tests/extremes/invariants.hpp"

namespace quicksand::test {
namespace {

using nlohmann::json;

/// Ends a run after some steps: a scene is drawn to show trouble, not to be finished.
struct Budget : RunMonitor {
  long steps = 0, most = 400;
  void progress(const Progress& p) override { steps = p.step; }
  bool cancelled() override { return steps >= most; }
};

struct Done {
  RunReport report;
  Recorder results;
};

Done compute(const Scene& scene, int threads) {
  Done done;
  Budget budget;
  done.report = run(scene, done.results, budget, {threads});
  return done;
}

/// A message that helps: when, and what to change.
bool explains(const Failure& f) {
  return (f.code == "diverged" || f.code == "max_steps") && f.message.find(" t = ") != std::string::npos &&
         f.message.size() > 80;
}

json judge(const json& asked) {
  json answer{{"id", asked.at("id")}, {"end", "ok"}, {"broken", json::array()}};
  const json& expected = asked.at("expected");
  const ParsedCase parsed = parse_case(asked.at("case").dump());
  if (!parsed.scene) {
    answer["end"] = "refused";
    for (const Fault& f : parsed.faults) {
      answer["why"].push_back(f.pointer + ": " + f.detail);
      if (f.detail.size() < 20) answer["broken"].push_back("refusal without a word");
    }
    return answer;
  }
  const Scene& scene = *parsed.scene;
  const Done done = compute(scene, 1);
  answer["steps"] = done.report.steps;
  answer["drift"] = done.report.ledger.water_volume_drift_max;
  if (done.report.status == RunStatus::failed) {
    answer["end"] = "diagnosed";
    answer["why"].push_back(done.report.failure.code + ": " + done.report.failure.message);
    if (!explains(done.report.failure)) answer["broken"].push_back("failure without a diagnosis");
  }
  for (const std::string& caution : done.report.cautions) {
    if (answer["end"] == "ok") answer["end"] = "told";
    answer["why"].push_back(caution);
  }
  Broken broken = invariants(scene, done.report, done.results);
  if (done.report.status != RunStatus::failed) {
    check_form(scene, expected.at("form").get<std::string>(), done.report, done.results, broken);
    if (expected.at("threads").get<bool>()) check_same(done.results, compute(scene, 3).results, broken);
    if (const json& twin = expected.at("twin"); !twin.is_null()) {
      const ParsedCase other = parse_case(twin.at("case").dump());
      if (!other.scene)
        broken.push_back("similar scene refused: " + other.faults.front().pointer + " " +
                         other.faults.front().detail);
      else
        check_similar(scene, done.results, compute(*other.scene, 1).results, twin.at("length").get<double>(),
                      twin.at("time").get<double>(), broken);
    }
  }
  for (const std::string& b : broken) answer["broken"].push_back(b);
  if (!answer["broken"].empty()) answer["end"] = "wrong";
  return answer;
}

}  // namespace
}  // namespace quicksand::test

int main() {
  // Three threads also on two cores.
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 3);
  for (std::string line; std::getline(std::cin, line);)
    std::cout << quicksand::test::judge(nlohmann::json::parse(line)).dump() << std::endl;
}

// Writes the known frames to a folder, for the readers in other languages: write_known FOLDER
#include <filesystem>

#include "engine/results/result_file.hpp"
#include "tests/engine/results/known_frames.hpp"

namespace {

// As much of a resolved case as cases/plot.py draws.
constexpr const char* resolved = R"({"name": "known", "numerics": {"preset": "draft", "points_per_cell": 2},
  "domain": {"min": [0, 0], "max": [70, 70], "cell_size": 0.5, "sides": {"top": {"kind": "open"}}},
  "bodies": [{"name": "sand", "kind": "soil"}, {"name": "plate", "kind": "soil", "fixed": true},
             {"name": "sea", "kind": "water"}],
  "walls": [{"name": "block", "block": {"box": {"min": [60, 0], "max": [70, 10]}}}],
  "gates": [{"name": "AB", "line": {"from": [0, 40], "to": [20, 40]}}],
  "stages": [{"name": "at rest", "open_gates": []}, {"name": "valve open", "open_gates": ["AB"]}]})";

}  // namespace

int main(int count, char** arguments) {
  using namespace quicksand;
  if (count != 2) return 2;
  std::filesystem::create_directories(arguments[1]);
  ResultFile file(arguments[1],
                  {{"case", "{\"name\": \"größer\"}"}, {"case_resolved", resolved}, {"empty", ""}});
  file.begin(known::series());
  std::size_t samples = 0;
  for (std::size_t k = 0; k < known::frames; ++k) {
    for (; samples < 100 * (k + 1); ++samples)
      file.sample(1e-3 * static_cast<double>(samples), known::sample(samples));
    file.frame(known::frame(k));
  }
  file.document("report", "{\"status\": \"running\"}");
  file.document("report", "{\"status\": \"succeeded\"}");
  file.close();
}

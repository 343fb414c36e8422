// Writes the known frames to a folder, for the readers in other languages: write_known FOLDER
#include <filesystem>

#include "engine/results/result_file.hpp"
#include "tests/engine/results/known_frames.hpp"

int main(int count, char** arguments) {
  using namespace quicksand;
  if (count != 2) return 2;
  std::filesystem::create_directories(arguments[1]);
  ResultFile file(arguments[1], {{"case", "{\"name\": \"größer\"}"}, {"empty", ""}});
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

#include "server/run_files.hpp"

#include <array>

#include "engine/results/checkpoint_file.hpp"
#include "engine/results/result_file.hpp"
#include "server/sha256.hpp"

namespace quicksand {
namespace {

/// The files of a complete run, and of a ladder.
constexpr std::array<const char*, 6> result_names{"result.vtkhdf", "result.xdmf",  "tradeoff.csv",
                                                  "tradeoff.svg",  "tradeoff.png", "run.json"};

}  // namespace

void remove_results(const std::filesystem::path& run_folder) {
  remove_result_files(run_folder.string());
  for (const std::string name : {"run.json", "tradeoff.csv", "tradeoff.svg", "tradeoff.png"})
    for (const char* ending : {"", ".part"}) std::filesystem::remove(run_folder / (name + ending));
}

void keep_unfinished_results(const std::filesystem::path& run_folder) {
  remove_checkpoints(run_folder);
  finish_result_files(run_folder.string());
}

std::vector<StoredResult> collect_results(const std::filesystem::path& run_folder) {
  std::vector<StoredResult> results;
  for (const char* name : result_names) {
    const auto file = run_folder / name;
    if (std::filesystem::is_regular_file(file))
      results.push_back({name, std::filesystem::file_size(file), sha256_file(file)});
  }
  return results;
}

}  // namespace quicksand

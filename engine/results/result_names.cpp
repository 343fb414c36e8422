#include "engine/results/result_names.hpp"

#include <stdexcept>
#include <string>
#include <system_error>

namespace quicksand {

namespace fs = std::filesystem;

fs::path unfinished(const fs::path& folder, const char* name) {
  return folder / (std::string(name) + ".part");
}

void finish_names(const fs::path& folder) {
  for (const char* name : {data_name, view_name}) {
    std::error_code error;
    fs::rename(unfinished(folder, name), folder / name, error);
    if (error) throw std::runtime_error(std::string("cannot rename ") + name + ": " + error.message());
  }
}

void unfinish_names(const fs::path& folder) {
  std::error_code none;
  for (const char* name : {data_name, view_name})
    if (!fs::exists(unfinished(folder, name), none))
      fs::rename(folder / name, unfinished(folder, name), none);
}

void remove_named_results(const fs::path& folder) {
  for (const char* name : {data_name, view_name}) {
    fs::remove(folder / name);
    fs::remove(unfinished(folder, name));
  }
}

}  // namespace quicksand

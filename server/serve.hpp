#pragma once
#include <filesystem>
#include <string>

#include "server/runner.hpp"

namespace quicksand {

struct ServeOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: the first free one from 8080
  std::filesystem::path state;
  std::filesystem::path cases;  ///< empty: none
  RunnerOptions runner;
};

/// Serves until SIGTERM or SIGINT. Prints the URL and the state folder on one line of standard output.
/// Throws std::runtime_error when it cannot start.
void serve(const ServeOptions& options);

}  // namespace quicksand

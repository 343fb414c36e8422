#pragma once
#include <httplib.h>

#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// An answer that is an error, RFC 9457.
struct Problem {
  int status = 500;
  std::string detail;
  std::vector<Fault> errors;  ///< 422: every fault of the case with its JSON pointer
  std::string allow;          ///< 405: the methods that would be right
  int retry_after_s = 0;      ///< 429, 503: when to try again
};

/// Thrown by handlers, caught by the dispatcher.
struct ProblemError {
  Problem problem;
};
[[noreturn]] void fail(int status, const std::string& detail);

std::string problem_json(const Problem& problem);
void answer(httplib::Response& response, const Problem& problem);

}  // namespace quicksand

#pragma once
// What each stage of a run does, in words.

#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

struct StagePlan {
  std::string name;
  double begin = 0, end = 0;      ///< s, if no stage ends early
  std::vector<std::string> does;  ///< plain sentences; empty: time passes
};

std::vector<StagePlan> plan_stages(const Scene& scene);

}  // namespace quicksand

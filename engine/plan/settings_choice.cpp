#include "engine/plan/settings_choice.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/plan/expected_error.hpp"
#include "engine/plan/plan.hpp"
#include "engine/scene/check.hpp"
#include "engine/scene/text.hpp"

namespace quicksand {
namespace {

/// Coarsest first. The verification cases reach from 4 to 1/4; the steps between are the ratios of small
/// numbers that divide most domains.
constexpr double kFactors[] = {4, 3, 2, 1.5, 4.0 / 3, 1.25, 1, 0.8, 0.75, 2.0 / 3, 0.5, 0.4, 1.0 / 3, 0.25};

Preset nearest_preset(double factor) {
  const double halvings = -std::log2(factor);
  return halvings < -0.5 ? Preset::draft : halvings > 0.5 ? Preset::fine : Preset::standard;
}

std::vector<Scene> that_fit(const std::function<Scene(Preset)>& with_preset) {
  std::vector<Scene> fitting;
  for (const double factor : kFactors) {
    Scene scene = with_preset(nearest_preset(factor));
    scene.numerics.cell_size_factor = factor;
    if (check(scene).empty()) fitting.push_back(std::move(scene));
  }
  return fitting;
}

/// Two digits, as more would claim to be known, rounded up, so that what is named is enough.
std::string up(double value) {
  constexpr double rounding = 1e-9;
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return text(std::ceil(value / unit - rounding) * unit);
}

std::string kind_words(const Scene& scene) {
  switch (error_class(scene)) {
    case ErrorClass::yielding:
      return "soil that may yield";
    case ErrorClass::free_water:
      return "water that moves freely";
    case ErrorClass::smooth:
      break;
  }
  return "soil that does not yield";
}

std::string cells_words(const Scene& scene) { return "cells of " + text(scene.cell_size()) + " m"; }

std::string reason(const Scene& scene, double seconds) {
  const Numerics& n = scene.numerics;
  std::string words = cells_words(scene) + ": ";
  if (n.target_error)
    words += "the largest that fit with an expected error of at most " + text(*n.target_error);
  else
    words += "the smallest that fit, down to a quarter of domain.cell_size, within " +
             text(*n.budget_seconds) + " s";
  words += "; " + kind_words(scene) + " is expected to err by " + up(expected_error(scene));
  return words + " there and to take " + up(seconds) + " s on one core";
}

SettingsChoice chosen(Scene scene, double seconds) {
  scene.numerics.chosen = reason(scene, seconds);
  return {std::move(scene), {}};
}

SettingsChoice within_error(const std::vector<Scene>& scenes, const Calibration& machine) {
  const Numerics& wanted = scenes.front().numerics;
  const auto found = std::find_if(scenes.begin(), scenes.end(), [&](const Scene& scene) {
    return expected_error(scene) <= *wanted.target_error * (1 + 1e-12);
  });
  if (found == scenes.end()) {
    const Scene& finest = scenes.back();
    return {{},
            Fault{"/numerics/target_error",
                  text(*wanted.target_error) + " cannot be expected: the smallest cells that fit, " +
                      text(finest.cell_size()) + " m, are expected to err by " + up(expected_error(finest)) +
                      " (" + kind_words(finest) + "); give " + up(expected_error(finest)) +
                      " to 1, or a smaller domain.cell_size"}};
  }
  const double seconds = make_plan(*found, machine).seconds;
  if (wanted.budget_seconds && seconds > *wanted.budget_seconds)
    return {
        {},
        Fault{"/numerics/budget_seconds", text(*wanted.budget_seconds) + " s are too few: target_error " +
                                              text(*wanted.target_error) + " needs " + cells_words(*found) +
                                              " and about " + up(seconds) + " s on one core; give at least " +
                                              up(seconds) + ", or a larger target_error"}};
  return chosen(*found, seconds);
}

SettingsChoice within_budget(const std::vector<Scene>& scenes, const Calibration& machine) {
  const double budget = *scenes.front().numerics.budget_seconds;
  const double least = make_plan(scenes.front(), machine).seconds;
  const Scene* best = nullptr;
  double best_seconds = 0, seconds = least;
  for (auto scene = scenes.begin(); seconds <= budget;) {
    best = &*scene, best_seconds = seconds;
    if (++scene == scenes.end()) break;
    seconds = make_plan(*scene, machine).seconds;
  }
  if (best) return chosen(*best, best_seconds);
  return {{},
          Fault{"/numerics/budget_seconds", text(budget) + " s are too few: the largest cells that fit, " +
                                                text(scenes.front().cell_size()) + " m, need about " +
                                                up(least) + " s on one core; give at least " + up(least) +
                                                ", shorter stages or a larger "
                                                "domain.cell_size"}};
}

}  // namespace

SettingsChoice choose_settings(const std::function<Scene(Preset)>& with_preset, const Calibration& machine) {
  const std::vector<Scene> scenes = that_fit(with_preset);
  const Scene standard = with_preset(Preset::standard);
  if (scenes.empty()) return {{}, check(standard).front()};
  return standard.numerics.target_error ? within_error(scenes, machine) : within_budget(scenes, machine);
}

}  // namespace quicksand

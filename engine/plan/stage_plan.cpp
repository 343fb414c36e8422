#include "engine/plan/stage_plan.hpp"

#include <algorithm>
#include <cstdio>

#include "engine/plan/quasi_static.hpp"
#include "engine/scene/stages.hpp"
#include "engine/scene/text.hpp"

namespace quicksand {
namespace {

using Sentences = std::vector<std::string>;

std::string listed(const std::vector<std::string>& names) {
  std::string words;
  for (const std::string& name : names) words += (words.empty() ? "" : ", ") + name;
  return words;
}

void say_gates(const Scene& scene, const Stage& stage, Sentences& does) {
  std::vector<std::string> closed;
  for (const Gate& gate : scene.gates)
    if (std::count(stage.open_gates.begin(), stage.open_gates.end(), gate.name) == 0)
      closed.push_back(gate.name);
  if (!stage.open_gates.empty()) does.push_back("Gates open: " + listed(stage.open_gates) + ".");
  if (!closed.empty()) does.push_back("Gates closed: " + listed(closed) + ".");
}

void say_heads(const Scene& scene, std::size_t index, Sentences& does) {
  for (const Reservoir& reservoir : scene.reservoirs) {
    const double after = head_after(scene, index, reservoir);
    const double before = index == 0 ? reservoir.head : head_after(scene, index - 1, reservoir);
    const double ramp = scene.stages[index].heads_ramp;
    std::string words = "Reservoir " + reservoir.name + ": level " + text(before) + " m";
    if (after != before)
      words += ", then " + text(after) + " m " + (ramp > 0 ? "over " + text(ramp) + " s" : "at once");
    does.push_back(words + ".");
  }
}

void say_loads(const Scene& scene, std::size_t index, Sentences& does) {
  for (const Load& load : scene.loads) {
    const bool now = acts(scene, index, load), before = index > 0 && acts(scene, index - 1, load);
    if (now && !before)
      does.push_back("Load " + load.name + " begins" +
                     (load.ramp > 0 ? ", rising over " + text(load.ramp) + " s." : " with its full value."));
    if (now && before) does.push_back("Load " + load.name + " goes on.");
    if (!now && before) does.push_back("Load " + load.name + " ends.");
  }
}

std::string figure(double value) {
  char words[32];
  std::snprintf(words, sizeof words, "%.3g", value);
  return words;
}

bool has_free_water(const Scene& scene, std::size_t index) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& body) {
    return body.kind == BodyKind::water && present(scene, index, body.name);
  });
}

void say_method(const Scene& scene, std::size_t index, Sentences& does) {
  const Stage& stage = scene.stages[index];
  if (stage.damping > 0)
    does.push_back(
        "Damping " + text(stage.damping) +
        ": that share of the out-of-balance force is turned against the motion; what rests is right, the "
        "way there is not.");
  if (stage.quasi_static)
    does.push_back("Quasi-static: inertia, never weight, is scaled so that a wave crosses the soil " +
                   text(scene.numerics.quasi_static_transits) +
                   " times within the process; whatever falls is slower than in nature.");
  if (const SlowProcess slow = slow_process(scene, index); slow.inertia > 1)
    does.push_back("Inertia is multiplied by " + figure(slow.inertia) + ": the process takes " +
                   figure(slow.process_time) + " s and a true wave " + figure(slow.transit_time) + " s.");
  if (stage.quasi_static && has_free_water(scene, index))
    does.push_back(
        "Free water is as heavy as ever but as slow as its scaled inertia: right at rest, its waves are "
        "not.");
  if (stage.until_rest)
    does.push_back("Ends at rest: when no point is faster than " + text(stage.until_rest->speed) + " m/s" +
                   (stage.until_rest->at_least > 0
                        ? ", not before " + text(stage.until_rest->at_least) + " s of it."
                        : "."));
}

}  // namespace

std::vector<StagePlan> plan_stages(const Scene& scene) {
  std::vector<StagePlan> plans;
  double time = 0;
  for (std::size_t k = 0; k < scene.stages.size(); ++k) {
    const Stage& stage = scene.stages[k];
    StagePlan plan{stage.name, time, time + stage.duration, {}};
    if (!stage.remove_bodies.empty())
      plan.does.push_back("Removes: " + listed(stage.remove_bodies) +
                          "; grains and water leave from wherever they are by then.");
    say_gates(scene, stage, plan.does);
    say_heads(scene, k, plan.does);
    say_loads(scene, k, plan.does);
    say_method(scene, k, plan.does);
    time = plan.end;
    plans.push_back(std::move(plan));
  }
  return plans;
}

}  // namespace quicksand

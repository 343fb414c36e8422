#include "server/calibrate_output.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "api/case_json.hpp"
#include "engine/run/frame.hpp"
#include "engine/study/calibrate.hpp"
#include "engine/study/cpu_time.hpp"
#include "server/execute.hpp"
#include "server/temporary_folder.hpp"

namespace quicksand {
namespace {

constexpr int kAllThreads = 0;  // output is written by a thread of its own
constexpr int kRounds = 4;

/// A run of dry soil, `across` cells wide, with the named fields or all.
struct Sample {
  int across;
  long steps;
  int frames;
  std::vector<std::string> fields;
  long good_every = RunOptions{}.good_every;
  double seconds = std::numeric_limits<double>::infinity();  ///< of processor time
};

double seconds_of(const Sample& sample, const std::filesystem::path& in) {
  Scene scene = calibration_scene(SceneKind::soil, sample.across, sample.steps, sample.frames);
  scene.output.fields = sample.fields;
  const std::string text = resolved_case(scene);
  const TemporaryFolder folder(in);
  RunMonitor monitor;
  RunOptions options;
  options.threads = 1;
  options.good_every = sample.good_every;
  const double before = cpu_seconds(kAllThreads);
  const Execution done = execute(text, {}, (folder.path() / "run").string(), monitor, options);
  if (!done.faults.empty()) throw std::runtime_error(done.faults.front().detail);
  if (done.report.status != RunStatus::succeeded) throw std::runtime_error(done.report.failure.message);
  return cpu_seconds(kAllThreads) - before;
}

}  // namespace

OutputCost calibrate_output(const std::filesystem::path& in, double effort) {
  const double process = cpu_seconds(kAllThreads);
  constexpr int few = 6, many = 60;  // cells
  constexpr int points_of_few = 4 * few * few, points_of_many = 4 * many * many;
  constexpr double held = 4;  // frames that are written at once where they come closer
  const int frames = std::max(16, static_cast<int>(64 * effort)), frames_of_many = frames / 4;
  const long steps = 64 * frames;
  const std::vector<std::string> all, one{frame_fields().front()};
  Sample stepped{few, steps, 2, all}, plain{few, frames, 2, all};
  Sample close{few, frames, frames, all}, close_one{few, frames, frames, one};
  // Each frame is written by itself, as those far apart are, but with no more steps than the others.
  Sample alone_plain{few, frames, 2, all, 1}, alone{few, frames, frames, all, 1};
  Sample large_plain{many, frames_of_many, 2, all}, large{many, frames_of_many, frames_of_many, all},
      large_one{many, frames_of_many, frames_of_many, one};
  // They differ by little. What else the machine does only adds to them, so the least of some counts, taken
  // in turns.
  for (int round = 0; round < kRounds; ++round)
    for (Sample* s :
         {&stepped, &plain, &close, &close_one, &alone_plain, &alone, &large_plain, &large, &large_one})
      s->seconds = std::min(s->seconds, seconds_of(*s, in));
  const auto of_frame = [](const Sample& with, const Sample& without) {
    return std::max(0.0, (with.seconds - without.seconds) / (with.frames - without.frames));
  };
  const double by_itself = of_frame(alone, alone_plain);  // frame + flush, of all fields
  const double together = of_frame(close, plain);         // frame + flush / held, of all fields
  const double of_one = of_frame(close_one, plain);       // the same, of one field
  const double of_points = of_frame(large, large_plain) - together;
  const double of_one_points = of_frame(large_one, large_plain) - of_one;
  const auto fields = static_cast<double>(frame_fields().size());
  constexpr int components = 14, components_of_one = 3;  // of all fields in the plane, of the first
  constexpr double points = points_of_many - points_of_few;
  OutputCost cost;
  cost.component = std::max(0.0, (of_points - of_one_points) / points) / (components - components_of_one);
  cost.frame_point = std::max(0.0, of_one_points / points - components_of_one * cost.component);
  cost.field = std::max(0.0, (together - of_one) / (fields - 1));
  cost.flush = std::max(0.0, (by_itself - together) / (1 - 1 / held));
  cost.frame = std::max(0.0, of_one - cost.flush / held - cost.field);
  const double step =
      std::max(0.0, stepped.seconds - plain.seconds) / static_cast<double>(stepped.steps - plain.steps);
  const double frames_of_plain = 2 * by_itself;
  cost.start =
      process + std::max(0.0, plain.seconds - frames_of_plain - static_cast<double>(plain.steps) * step -
                                  points_of_few * cost.seed_point);
  return cost;
}

}  // namespace quicksand

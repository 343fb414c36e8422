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
  const long between_flushes = RunOptions{}.good_every;
  constexpr double held = 4;  // frames that are written at once where they come closer
  const int frames = std::max(8, static_cast<int>(32 * effort));
  const long steps = between_flushes * (frames - 1);
  const std::vector<std::string> all, one{frame_fields().front()};
  Sample plain{few, steps, 2, all}, rare{few, steps, frames, all};
  Sample close_plain{few, frames, 2, all}, close{few, frames, frames, all}, small{few, frames, frames, one};
  Sample large_plain{many, frames, 2, all}, large_one{many, frames, frames, one},
      large{many, frames, frames, all};
  // They differ by little. What else the machine does only adds to them, so the least of some counts, taken
  // in turns.
  for (int round = 0; round < kRounds; ++round)
    for (Sample* s : {&plain, &rare, &close_plain, &close, &small, &large_plain, &large_one, &large})
      s->seconds = std::min(s->seconds, seconds_of(*s, in));
  const auto of_frame = [&](const Sample& with, const Sample& without) {
    return std::max(0.0, (with.seconds - without.seconds) / (frames - 2));
  };
  const double alone = of_frame(rare, plain);            // frame + flush
  const double together = of_frame(close, close_plain);  // frame + flush / held
  const auto fields = static_cast<double>(frame_fields().size());
  constexpr int components = 14, of_one = 3;  // of all fields in the plane, of the first
  constexpr double points = points_of_many - points_of_few;
  const auto at_points = [&](const Sample& of_many, const Sample& of_few) {
    const double seeded = large_plain.seconds - close_plain.seconds;
    return std::max(0.0, (of_many.seconds - of_few.seconds - seeded) / (frames - 2)) / points;
  };
  OutputCost cost;
  cost.component =
      std::max(0.0, at_points(large, close) - at_points(large_one, small)) / (components - of_one);
  cost.frame_point = std::max(0.0, at_points(large_one, small) - of_one * cost.component);
  cost.field = of_frame(close, small) / (fields - 1);
  cost.flush = std::max(0.0, (alone - together) / (1 - 1 / held));
  cost.frame = std::max(0.0, alone - cost.flush - fields * cost.field);
  const double step =
      std::max(0.0, plain.seconds - close_plain.seconds) / static_cast<double>(steps - frames);
  const double first = 2 * alone;  // frames of `close_plain`
  cost.start =
      process + std::max(0.0, close_plain.seconds - first - frames * step - points_of_few * cost.seed_point);
  return cost;
}

}  // namespace quicksand

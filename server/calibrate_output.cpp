#include "server/calibrate_output.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
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

/// s of processor time, the median of three runs of dry soil, `across` cells wide, with the named fields or
/// all.
double run_seconds(const std::filesystem::path& in, int across, long steps, int frames,
                   std::vector<std::string> fields = {}) {
  Scene scene = calibration_scene(SceneKind::soil, across, steps, frames);
  scene.output.fields = std::move(fields);
  const std::string text = resolved_case(scene);
  std::array<double, 3> taken{};
  for (double& t : taken) {
    const TemporaryFolder folder(in);
    RunMonitor monitor;
    RunOptions options;
    options.threads = 1;
    const double before = cpu_seconds(kAllThreads);
    const Execution done = execute(text, {}, (folder.path() / "run").string(), monitor, options);
    t = cpu_seconds(kAllThreads) - before;
    if (!done.faults.empty()) throw std::runtime_error(done.faults.front().detail);
    if (done.report.status != RunStatus::succeeded) throw std::runtime_error(done.report.failure.message);
  }
  std::sort(taken.begin(), taken.end());
  return taken[1];
}

}  // namespace

OutputCost calibrate_output(const std::filesystem::path& in, double effort) {
  const double process = cpu_seconds(kAllThreads);
  constexpr int few = 6, many = 60;  // cells
  constexpr int points_of_few = 4 * few * few, points_of_many = 4 * many * many;
  const long between_flushes = RunOptions{}.good_every;
  constexpr double held = 4;  // frames that are written at once where they come closer
  const int frames = std::max(3, static_cast<int>(32 * effort));
  const long steps = between_flushes * (frames - 1);
  const double plain = run_seconds(in, few, steps, 2), rare = run_seconds(in, few, steps, frames);
  const double close_plain = run_seconds(in, few, frames, 2), close = run_seconds(in, few, frames, frames);
  const double alone = std::max(0.0, (rare - plain) / (frames - 2));            // frame + flush
  const double together = std::max(0.0, (close - close_plain) / (frames - 2));  // frame + flush / held
  // Of a frame with one field and with all, of few points and of many.
  const std::string& one = frame_fields().front();
  const double small = run_seconds(in, few, frames, frames, {one});
  const double large_plain = run_seconds(in, many, frames, 2);
  const double large_one = run_seconds(in, many, frames, frames, {one});
  const double large = run_seconds(in, many, frames, frames);
  const auto of_frame = [&](double with, double without) {
    return std::max(0.0, (with - without) / (frames - 2));
  };
  const auto fields = static_cast<double>(frame_fields().size());
  constexpr int components = 14, of_one = 3;  // of all fields in the plane, of the first
  constexpr double points = points_of_many - points_of_few;
  const double at_points = of_frame(large_one - small, large_plain - close_plain) / points;
  const double at_points_of_all = of_frame(large - close, large_plain - close_plain) / points;
  OutputCost cost;
  cost.component = std::max(0.0, at_points_of_all - at_points) / (components - of_one);
  cost.frame_point = std::max(0.0, at_points - of_one * cost.component);
  cost.field = of_frame(close, small) / (fields - 1);
  cost.flush = std::max(0.0, (alone - together) / (1 - 1 / held));
  cost.frame = std::max(0.0, alone - cost.flush - fields * cost.field);
  const double step = std::max(0.0, plain - close_plain) / static_cast<double>(steps - frames);
  const double first = 2 * alone;  // frames of `close_plain`
  cost.start = process + std::max(0.0, close_plain - first - frames * step - points_of_few * cost.seed_point);
  return cost;
}

}  // namespace quicksand

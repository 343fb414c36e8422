#include "server/limits.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/machine.hpp"

namespace quicksand {
namespace {

/// Part of the machine's memory that runs may take when `max_memory` does not say.
constexpr double default_memory_share = 0.8;
/// Bytes that the service itself and the allocator's slack may take besides the runs.
constexpr double own_memory = 512e6;

std::string gigabytes(double bytes) { return fmt::format("{:.3g} GB", bytes / 1e9); }

}  // namespace

RunCost cost_of(const Plan& plan) {
  const std::size_t points = plan.soil_points + plan.fixed_soil_points + plan.water_points;
  return {static_cast<std::int64_t>(points), plan.memory_bytes, plan.seconds};
}

RunCost cost_of(const TradeoffCost& cost) {
  return {static_cast<std::int64_t>(cost.points), cost.memory_bytes, cost.seconds};
}

double memory_limit(const Settings& settings) {
  return settings.max_memory > 0 ? static_cast<double>(settings.max_memory)
                                 : default_memory_share * machine_memory();
}

int threads_for(const Settings& settings, const RunCost& cost) {
  if (settings.threads_per_run > 0) return static_cast<int>(settings.threads_per_run);
  const std::int64_t useful = cost.points / settings.points_per_thread;
  return static_cast<int>(std::clamp<std::int64_t>(useful, 1, machine_cores()));
}

std::vector<Fault> too_large(const Settings& settings, const RunCost& cost) {
  std::vector<Fault> faults;
  if (cost.points > settings.max_points)
    faults.push_back(
        {"/domain/cell_size", fmt::format("{} points; at most {}: choose larger cells", cost.points,
                                          named_limit(settings, &Settings::max_points))});
  if (cost.memory_bytes > memory_limit(settings))
    faults.push_back({"/domain/cell_size",
                      fmt::format("the run needs {} of memory; at most {} (max_memory): choose larger cells",
                                  gigabytes(cost.memory_bytes), gigabytes(memory_limit(settings)))});
  return faults;
}

std::string disk_shortage(const Settings& settings, const StateFolder& folder, double results_bytes) {
  std::error_code unknown;
  const auto space = std::filesystem::space(folder.path(), unknown);
  const double reserve = static_cast<double>(settings.disk_reserve);
  if (!unknown && static_cast<double>(space.available) < reserve)
    return fmt::format("{} of the disk are free; {} stay in reserve",
                       gigabytes(static_cast<double>(space.available)),
                       named_limit(settings, &Settings::disk_reserve));
  const double quota = static_cast<double>(settings.disk_quota);
  if (quota > 0 && results_bytes > quota)
    return fmt::format("the results take {}; at most {}: delete runs that are no longer needed",
                       gigabytes(results_bytes), named_limit(settings, &Settings::disk_quota));
  return "";
}

double folder_bytes(const std::filesystem::path& folder) {
  double bytes = 0;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator(folder, gone)) {
    const auto size = entry.file_size(gone);
    if (!gone) bytes += static_cast<double>(size);
  }
  return bytes;
}

std::optional<Failure> out_of_time(const Settings& settings, double seconds) {
  if (settings.max_run_s == 0 || seconds < static_cast<double>(settings.max_run_s)) return {};
  return Failure{
      "time_limit",
      fmt::format("the run computed for longer than {} s; its frames until then are kept. Choose larger "
                  "cells or a shorter duration",
                  named_limit(settings, &Settings::max_run_s)),
      0,
      {}};
}

std::optional<Failure> out_of_memory(const Settings& settings, double resident_bytes) {
  if (resident_bytes < memory_limit(settings) + own_memory) return {};
  return Failure{
      "memory_limit",
      fmt::format("the runs took {} of memory, more than was planned and than they may: {} (max_memory)",
                  gigabytes(resident_bytes - own_memory), gigabytes(memory_limit(settings))),
      0,
      {}};
}

}  // namespace quicksand

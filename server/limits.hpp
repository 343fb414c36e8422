#pragma once
// What a case and a run may take; each refusal names the limit, the value and the setting.

#include <optional>
#include <string>

#include "engine/plan/plan.hpp"
#include "engine/run/run.hpp"
#include "engine/study/tradeoff.hpp"
#include "server/settings.hpp"
#include "server/state_folder.hpp"
#include "server/store.hpp"

namespace quicksand {

RunCost cost_of(const Plan& plan);
RunCost cost_of(const TradeoffCost& cost);

/// Bytes that the runs may take together.
double memory_limit(const Settings& settings);

/// Threads that a run of this size keeps busy.
int threads_for(const Settings& settings, const RunCost& cost);

/// Why a plan is too large for this service; empty when it is not.
std::vector<Fault> too_large(const Settings& settings, const RunCost& cost);

/// Why nothing more may be written; empty when there is room. `results_bytes`: of the ended runs.
std::string disk_shortage(const Settings& settings, const StateFolder& folder, double results_bytes);

/// Bytes of the files in a folder.
double folder_bytes(const std::filesystem::path& folder);

/// Why a run has to end that has computed for so long; empty when it need not.
std::optional<Failure> out_of_time(const Settings& settings, double seconds);

/// Why runs have to end while the process takes so much memory; empty when they need not.
std::optional<Failure> out_of_memory(const Settings& settings, double resident_bytes);

}  // namespace quicksand

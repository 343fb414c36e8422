#include "server/run_json.hpp"

namespace quicksand {
namespace {

Json time_or_null(const std::optional<Milliseconds>& time) {
  return time ? Json(rfc3339(*time)) : Json(nullptr);
}

/// When the results will be removed by policy; empty when they will not, or were.
std::optional<Milliseconds> expires(const StoredRun& run, const Settings& settings) {
  constexpr Milliseconds day_ms = 24LL * 3600 * 1000;
  if (settings.keep_days == 0 || run.expired || !run.finished) return {};
  return *run.finished + settings.keep_days * day_ms;
}

}  // namespace

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string progress_json(const Progress& progress) {
  return dump({{"fraction", progress.fraction},
               {"stage", progress.stage},
               {"sim_time", progress.sim_time},
               {"end_time", progress.end_time},
               {"step", progress.step},
               {"time_step", progress.time_step},
               {"bound", progress.bound},
               {"frames", progress.frames},
               {"eta_s", progress.eta_s}});
}

Json run_json(const StoredRun& run, const Settings& settings) {
  const std::string self = "/v1/runs/" + run.id;
  Json json{{"id", run.id},
            {"status", state_name(run.state)},
            {"name", run.name},
            {"label", run.label},
            {"owner", run.owner.empty() ? Json(nullptr) : Json(run.owner)},
            {"created", rfc3339(run.created)},
            {"started", time_or_null(run.started)},
            {"finished", time_or_null(run.finished)},
            {"results_expire", time_or_null(expires(run, settings))},
            {"results_removed", time_or_null(run.expired)},
            {"priority", run.priority},
            {"kind", kind_name(run.kind)},
            {"budget_s", run.kind == RunKind::tradeoff ? Json(run.budget) : Json(nullptr)},
            {"estimated_s", run.cost.seconds},
            {"progress", run.progress.empty() ? Json(nullptr) : Json::parse(run.progress)},
            {"failure", nullptr},
            {"retries", run.retries},
            {"engine_version", run.engine_version},
            {"case_sha256", run.case_sha256},
            {"links",
             {{"self", self},
              {"case", self + "/case"},
              {"log", self + "/log"},
              {"events", self + "/events"},
              {"series", self + "/series"},
              {"results", self + "/results"}}}};
  if (run.failure)
    json["failure"] = {{"code", run.failure->code},
                       {"message", run.failure->message},
                       {"at", {{"time", run.failure->time}, {"place", run.failure->place}}}};
  return json;
}

Json results_json(const std::string& id, const std::vector<StoredResult>& results) {
  Json list = Json::array();
  for (const StoredResult& result : results)
    list.push_back({{"name", result.name},
                    {"bytes", result.bytes},
                    {"sha256", result.sha256},
                    {"href", "/v1/runs/" + id + "/results/" + result.name}});
  return {{"results", list}};
}

}  // namespace quicksand

#include <spdlog/spdlog.h>

#include <algorithm>

#include "api/case_json.hpp"
#include "server/http_parameters.hpp"
#include "server/http_problem.hpp"
#include "server/limits.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"
#include "server/version.hpp"

namespace quicksand {
namespace {

constexpr std::size_t max_label_bytes = 128;
constexpr std::size_t max_key_bytes = 255;
constexpr int default_page = 50;
constexpr int max_priority = 10;
constexpr int max_trial_s = 5;
constexpr int full_queue_retry_s = 60;  ///< s, `Retry-After` of a full queue

constexpr int default_budget_s = 600, max_budget_s = 1'000'000;  ///< s of CPU time of a tradeoff

struct PlannedCase {
  Scene scene;
  Plan plan;
};

void refuse_too_large(const Settings& settings, const RunCost& cost) {
  Problem problem;
  problem.status = 422;
  problem.detail = "the case cannot be run";
  problem.errors = too_large(settings, cost);
  if (!problem.errors.empty()) throw ProblemError{problem};
}

/// The body as a scene that this service may run, or 422 with every fault.
PlannedCase plan_case(const Settings& settings, const Calibration& machine, const std::string& text) {
  ParsedCase parsed = parse_case(text, {}, machine);
  Problem problem;
  problem.status = 422;
  problem.detail = "the case cannot be run";
  problem.errors = std::move(parsed.faults);
  if (!parsed.scene) throw ProblemError{problem};
  PlannedCase planned{*parsed.scene, make_plan(*parsed.scene, machine)};
  refuse_too_large(settings, cost_of(planned.plan));
  return planned;
}

void refuse_on_a_full_disk(Service& service) {
  const std::string shortage = service.runner.shortage();
  if (!shortage.empty()) fail(507, shortage);
}

/// Without keys there are no owners to be fair to.
QueueLimits queue_limits(const Settings& settings, const std::string& owner) {
  return {settings.max_queued, owner.empty() ? INT64_MAX : settings.max_runs_per_key};
}

int checked_priority(const Call& call) {
  const int priority = checked_number<int>(call, "priority", -max_priority, max_priority, 0);
  if (priority > 0 && call.caller.role != Role::admin)
    fail(403, "priority above 0 needs a key with the role admin");
  return priority;
}

/// Sets the kind and, of a tradeoff, its budget.
RunKind read_kind(const Call& call, NewRun& wanted) {
  const std::string kind = call.request.has_param("kind") ? call.parameter("kind") : "run";
  if (kind != "run" && kind != "tradeoff") fail(400, "kind: run or tradeoff");
  if (kind == "run" && call.request.has_param("budget"))
    fail(400, "budget has no effect without kind=tradeoff");
  wanted.kind = kind == "tradeoff" ? RunKind::tradeoff : RunKind::run;
  if (wanted.kind == RunKind::tradeoff)
    wanted.budget = checked_number<int>(call, "budget", 1, max_budget_s, default_budget_s);
  return wanted.kind;
}

std::string checked_label(const Call& call) {
  const std::string label = call.parameter("label");
  const bool printable = std::all_of(label.begin(), label.end(), [](unsigned char c) { return c >= ' '; });
  if (label.size() > max_label_bytes || !printable)
    fail(400, "label: at most " + std::to_string(max_label_bytes) + " bytes without control characters");
  return label;
}

std::string checked_key(const Call& call) {
  if (!call.request.has_header("Idempotency-Key")) return {};
  const std::string key = call.request.get_header_value("Idempotency-Key");
  const bool plain = std::all_of(key.begin(), key.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (key.empty() || key.size() > max_key_bytes || !plain)
    fail(400, "Idempotency-Key: 1 to " + std::to_string(max_key_bytes) + " printable ASCII characters");
  return key;
}

RunFilter checked_filter(const Call& call, const Settings& settings) {
  RunFilter filter;
  if (call.request.has_param("status")) {
    filter.state = state_from_name(call.parameter("status"));
    if (!filter.state) fail(400, "status: queued, running, canceling, succeeded, failed or canceled");
  }
  if (call.request.has_param("label")) filter.label = call.parameter("label");
  if (call.request.has_param("name_prefix")) filter.name_prefix = call.parameter("name_prefix");
  if (call.request.has_param("created_after")) {
    filter.created_after = parse_rfc3339(call.parameter("created_after"));
    if (!filter.created_after) fail(400, "created_after: a UTC time such as 2024-05-06T07:08:09Z");
  }
  if (call.request.has_param("page_token"))
    filter.before_sequence = checked_number<long long>(call, "page_token", 1, INT64_MAX, 0);
  if (call.caller.role == Role::submit) filter.owner = call.caller.name;
  filter.limit = checked_number<int>(call, "limit", 1, static_cast<int>(settings.max_page), default_page);
  return filter;
}

}  // namespace

StoredRun run_of(Service& service, const Call& call) {
  auto run = service.store.find(call.captured.at(0));
  if (!run || !call.caller.sees(run->owner)) fail(404, "no run " + call.captured.at(0));
  return *run;
}

StoredRun run_with_results(Service& service, const Call& call) {
  StoredRun run = run_of(service, call);
  if (run.expired)
    fail(410,
         "the results were removed at " + rfc3339(*run.expired) + " by the service's policy (keep_days)");
  return run;
}

void post_run(Service& service, const Call& call, httplib::Response& response) {
  NewRun wanted;
  wanted.label = checked_label(call);
  wanted.idempotency_key = checked_key(call);
  wanted.priority = checked_priority(call);
  refuse_on_a_full_disk(service);
  const PlannedCase planned = plan_case(service.settings, service.machine, call.request.body);
  wanted.name = planned.scene.name;
  wanted.cost = cost_of(planned.plan);
  if (read_kind(call, wanted) == RunKind::tradeoff) {
    wanted.cost = cost_of(tradeoff_cost(planned.scene, wanted.budget, service.machine));
    refuse_too_large(service.settings, wanted.cost);
  }
  wanted.owner = call.caller.name;
  wanted.case_text = call.request.body;
  wanted.engine_version = engine_version;
  const CreateOutcome outcome = service.store.create(wanted, queue_limits(service.settings, wanted.owner));
  switch (outcome.kind) {
    case CreateOutcome::Kind::conflict:
      fail(422, "this Idempotency-Key was used for another case or label");
    case CreateOutcome::Kind::over_quota:
      throw ProblemError{{429,
                          wanted.owner + " has as many runs waiting or computing as one key may: " +
                              named_limit(service.settings, &Settings::max_runs_per_key),
                          {},
                          {},
                          full_queue_retry_s}};
    case CreateOutcome::Kind::full:
      throw ProblemError{{503,
                          "the queue is full: " + named_limit(service.settings, &Settings::max_queued),
                          {},
                          {},
                          full_queue_retry_s}};
    case CreateOutcome::Kind::created:
      spdlog::info("run={} queued owner={} name={}", outcome.run->id, quoted(outcome.run->owner),
                   quoted(outcome.run->name));
      service.runner.wake();
      break;
    case CreateOutcome::Kind::repeated:
      break;
  }
  response.status = 201;
  response.set_header("Location", "/v1/runs/" + outcome.run->id);
  response.set_content(dump(run_json(*outcome.run, service.settings)), "application/json");
}

void post_validate(Service& service, const Call& call, httplib::Response& response) {
  const int seconds = checked_number<int>(call, "trial", 0, max_trial_s, 0);
  PlannedCase planned = plan_case(service.settings, service.machine, call.request.body);
  std::optional<Trial> trial;
  if (seconds > 0) {
    const auto place = service.trials.take();
    if (!place)
      throw ProblemError{{503,
                          "too many trials: " + named_limit(service.settings, &Settings::max_trials),
                          {},
                          {},
                          max_trial_s}};
    trial = make_trial(planned.scene, service.machine, seconds, [&] { return service.stopping.load(); });
    foretell(*trial, planned.scene, service.machine, planned.plan);
  }
  response.set_content(estimate_json(call.request.body, planned.plan, service.machine, trial),
                       "application/json");
}

void get_runs(Service& service, const Call& call, httplib::Response& response) {
  RunFilter filter = checked_filter(call, service.settings);
  const auto page = static_cast<std::size_t>(filter.limit);
  ++filter.limit;  // one more tells whether there is a next page
  std::vector<StoredRun> runs = service.store.list(filter);
  Json next = nullptr;
  if (runs.size() > page) {
    runs.resize(page);
    next = std::to_string(runs.back().sequence);
  }
  Json list = Json::array();
  for (const StoredRun& run : runs) list.push_back(run_json(run, service.settings));
  response.set_content(dump({{"runs", list}, {"next_page_token", next}}), "application/json");
}

void post_cancel(Service& service, const Call& call, httplib::Response& response) {
  const auto run = service.runner.cancel(run_of(service, call).id);
  if (!run) fail(404, "no run " + call.captured.at(0));
  spdlog::info("run={} cancel asked for, now {}", run->id, state_name(run->state));
  response.set_content(dump(run_json(*run, service.settings)), "application/json");
}

void delete_run(Service& service, const Call& call, httplib::Response& response) {
  const std::string id = run_of(service, call).id;
  switch (service.store.remove(id)) {
    case Store::Removal::unknown:
      fail(404, "no run " + id);
    case Store::Removal::active:
      fail(409, "the run has not ended; cancel it first");
    case Store::Removal::removed:
      break;
  }
  std::error_code left_behind;  // removed at the next start
  std::filesystem::remove_all(service.folder.run(id), left_behind);
  if (left_behind) spdlog::warn("run={} its files could not be removed", id);
  spdlog::info("run={} deleted", id);
  service.bell.ring();
  response.status = 204;
}

}  // namespace quicksand

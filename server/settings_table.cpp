#include "server/settings.hpp"

namespace quicksand {
namespace {

using Kind = Setting::Kind;

constexpr Count many = 1'000'000;

}  // namespace

const std::vector<Setting>& settings_table() {
  static const std::vector<Setting> table{
      {Kind::text, "host", &Settings::host, 0, 0,
       "Address to listen at. Any other than this machine's own (127.0.0.1, ::1, localhost) needs API keys."},
      {Kind::count, "port", &Settings::port, 0, 65535, "TCP port; 0: the first free one from 8080."},
      {Kind::text, "state", &Settings::state, 0, 0,
       "Folder of the runs and their records. One server at a time owns it."},
      {Kind::text, "cases", &Settings::cases, 0, 0, "Folder of shipped cases; empty: none."},
      {Kind::text, "log_level", &Settings::log_level, 0, 0,
       "What is written on standard error: debug, info, warning or error."},

      {Kind::count, "workers", &Settings::workers, 1, 64, "Runs computed at a time."},
      {Kind::count, "short_workers", &Settings::short_workers, 0, 64,
       "So many of the workers take only short runs, so that a draft does not wait for a long one to end.\n"
       "At least one worker takes any run. Among those that wait, higher priorities go first, then the user\n"
       "who has waited longest since a run of his began, then the oldest run."},
      {Kind::count, "short_run_s", &Settings::short_run_s, 1, many,
       "A run is short when its plan estimates at most so many seconds."},
      {Kind::count, "threads_per_run", &Settings::threads_per_run, 0, 1024,
       "Threads per run; 0: by its size, one for every points_per_thread, at most one per core. The result "
       "is\n"
       "the same whatever their number."},
      {Kind::count, "points_per_thread", &Settings::points_per_thread, 1, many,
       "Points that keep one thread busy. Measured (tests/bench/threads.py): a second thread makes a run "
       "1.0\n"
       "times as fast at 1 300 points, 1.2 at 4 000, 1.3 at 10 000 and 1.5 at 150 000; below, the core is "
       "better\n"
       "given to another run."},
      {Kind::count, "niceness", &Settings::niceness, 0, 19,
       "How much nicer, as nice(1) counts it, what computes is than the service itself: where runs take all\n"
       "cores, answers go first. 0: both are equal."},

      {Kind::count, "checkpoint_s", &Settings::checkpoint_s, 0, 24 * 3600,
       "Between two checkpoints of a run, s; the first ones come sooner. After a kill, a power loss or a\n"
       "restart a run goes on from its last one, with the same results. 0: none while it computes, only at\n"
       "an orderly stop."},

      {Kind::bytes, "max_body_bytes", &Settings::max_body_bytes, 1024, 64 << 20,
       "Largest case that is taken; larger ones get 413."},
      {Kind::count, "max_queued", &Settings::max_queued, 1, many,
       "Runs that may wait; further ones get 503."},
      {Kind::count, "max_runs_per_key", &Settings::max_runs_per_key, 1, many,
       "Runs that the owner of an API key may have waiting and computing; further ones get 429."},
      {Kind::count, "max_points", &Settings::max_points, 1, 1'000'000'000,
       "Points of one case; larger ones get 422."},
      {Kind::bytes, "max_memory", &Settings::max_memory, 0, INT64_MAX,
       "Memory of all runs together; 0: 80 % of the machine's (or of what its control group allows). A case\n"
       "whose plan needs more gets 422; a run starts when its plan fits beside those that compute; should "
       "runs\n"
       "take more than planned, the newest is ended with the code memory_limit."},
      {Kind::count, "max_run_s", &Settings::max_run_s, 0, 366 * 24 * 3600,
       "Longest time that a run may compute, s, what it computed before it was interrupted included; then "
       "it\n"
       "ends with the code time_limit. 0: no bound."},

      {Kind::bytes, "disk_reserve", &Settings::disk_reserve, 0, INT64_MAX,
       "Stays free on the disk of the state folder. With less, new runs get 507, those that compute stop "
       "with\n"
       "the code disk_full and wait like all others; they go on from there when there is room again."},
      {Kind::bytes, "disk_quota", &Settings::disk_quota, 0, INT64_MAX,
       "All results together; beyond it the same happens. 0: no bound."},
      {Kind::count, "keep_days", &Settings::keep_days, 0, 36500,
       "Results are removed so many days after their run ended; its record and log stay and say so.\n"
       "0: they are kept until somebody deletes them."},

      {Kind::text, "cors_origin", &Settings::cors_origin, 0, 0,
       "Origin of the one other site whose pages may use the service, such as https://lab.example;\nempty: "
       "none."},

      {Kind::count, "max_page", &Settings::max_page, 1, 1000, "Runs in one answer of the list."},
      {Kind::count, "max_wait_s", &Settings::max_wait_s, 1, 60, "Longest long poll, s."},
      {Kind::count, "max_waiters", &Settings::max_waiters, 0, 256,
       "Long polls at a time; the next one is answered at once."},
      {Kind::count, "max_streams", &Settings::max_streams, 0, 256,
       "Event streams at a time; the next one gets 503."},
      {Kind::count, "max_readers", &Settings::max_readers, 0, 64,
       "Answers with frames or series at a time; the next one gets 503. Each takes up to\n"
       "max_data_bytes of memory until its client has read it."},
      {Kind::count, "max_downloads", &Settings::max_downloads, 0, 256,
       "Result files and logs that are sent at a time; the next one gets 503."},
      {Kind::count, "max_trials", &Settings::max_trials, 0, 16,
       "Trial runs for /v1/validate at a time, a core for seconds each; the next one gets 503."},
      {Kind::bytes, "max_data_bytes", &Settings::max_data_bytes, 1 << 10, 1 << 30,
       "Most data in one answer with a frame or series; what would be larger gets 400."},
  };
  return table;
}

}  // namespace quicksand

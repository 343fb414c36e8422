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
      {Kind::count, "threads_per_run", &Settings::threads_per_run, 0, 1024, "Threads per run; 0: all cores."},

      {Kind::bytes, "max_body_bytes", &Settings::max_body_bytes, 1024, 64 << 20,
       "Largest case that is taken; larger ones get 413."},
      {Kind::count, "max_queued", &Settings::max_queued, 1, many,
       "Runs that may wait; further ones get 503."},
      {Kind::count, "max_runs_per_key", &Settings::max_runs_per_key, 1, many,
       "Runs that one API key (without keys: everybody together) may have waiting and computing;\n"
       "further ones get 429."},

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
      {Kind::bytes, "max_data_bytes", &Settings::max_data_bytes, 1 << 10, 1 << 30,
       "Most data in one answer with a frame or series; what would be larger gets 400."},
  };
  return table;
}

}  // namespace quicksand

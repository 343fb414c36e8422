#include "server/machine.hpp"
#include "server/route_handlers.hpp"

namespace quicksand {
void get_metrics(Service& service, const Call&, httplib::Response& response) {
  Metrics& metrics = service.metrics;
  for (const RunState state : all_run_states)
    metrics.set("runs", "Runs by status; queued ones are the length of the queue.",
                service.store.count(state), "status", state_name(state));
  std::error_code unknown;
  const auto space = std::filesystem::space(service.folder.path(), unknown);
  if (!unknown)
    metrics.set("disk_free_bytes", "Free on the disk of the state folder.",
                static_cast<double>(space.available));
  metrics.set("results_bytes", "Results of ended runs.", service.store.results_bytes());
  metrics.set("streams", "Event streams that are open.", static_cast<double>(service.streams.taken()));
  metrics.set("waiters", "Long polls that are held.", static_cast<double>(service.waiters.taken()));
  metrics.set("resident_bytes", "Memory of the process, its runs included.", resident_memory());
  metrics.set("start_time_seconds", "When the service started, s since 1970 UTC.",
              static_cast<double>(service.started) / 1000);
  response.set_content(metrics.text(), "text/plain; version=0.0.4; charset=utf-8");
}

}  // namespace quicksand

#pragma once
// The handlers of the route table; what each answers is in api/openapi.yaml. They throw ProblemError.

#include "server/service.hpp"

namespace quicksand {

// route_runs.cpp
void post_run(Service& service, const Call& call, httplib::Response& response);
void post_validate(Service& service, const Call& call, httplib::Response& response);
void get_runs(Service& service, const Call& call, httplib::Response& response);
void delete_run(Service& service, const Call& call, httplib::Response& response);
void post_cancel(Service& service, const Call& call, httplib::Response& response);

// route_status.cpp
void get_run(Service& service, const Call& call, httplib::Response& response);

// route_events.cpp
void get_run_events(Service& service, const Call& call, httplib::Response& response);

// route_data.cpp
void get_frame(Service& service, const Call& call, httplib::Response& response);
void get_series(Service& service, const Call& call, httplib::Response& response);

// route_results.cpp
void get_run_case(Service& service, const Call& call, httplib::Response& response);
void get_run_log(Service& service, const Call& call, httplib::Response& response);
void get_results(Service& service, const Call& call, httplib::Response& response);
void get_result_file(Service& service, const Call& call, httplib::Response& response);

// route_catalogue.cpp
void get_cases(Service& service, const Call& call, httplib::Response& response);
void get_case(Service& service, const Call& call, httplib::Response& response);
void get_case_schema(Service& service, const Call& call, httplib::Response& response);
void get_openapi(Service& service, const Call& call, httplib::Response& response);
void get_service_info(Service& service, const Call& call, httplib::Response& response);
void get_healthz(Service& service, const Call& call, httplib::Response& response);
void get_readyz(Service& service, const Call& call, httplib::Response& response);

// route_metrics.cpp
void get_metrics(Service& service, const Call& call, httplib::Response& response);

/// The run of the route's first `{id}`, or 404.
StoredRun run_of(Service& service, const Call& call);
/// The same, or 410 when its results were removed by policy.
StoredRun run_with_results(Service& service, const Call& call);

}  // namespace quicksand

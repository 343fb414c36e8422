#include <spdlog/spdlog.h>

#include "api/case_json.hpp"
#include "api/openapi.hpp"
#include "engine/run/engine_build.hpp"
#include "server/http_problem.hpp"
#include "server/limits.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"
#include "server/version.hpp"

namespace quicksand {

void get_cases(Service& service, const Call&, httplib::Response& response) {
  Json list = Json::array();
  for (const auto& [name, shipped] : service.cases)
    list.push_back({{"name", name}, {"description", shipped.description}, {"href", "/v1/cases/" + name}});
  response.set_content(dump({{"cases", list}}), "application/json");
}

void get_case(Service& service, const Call& call, httplib::Response& response) {
  const auto found = service.cases.find(call.captured.at(0));
  if (found == service.cases.end()) fail(404, "no shipped case " + call.captured.at(0));
  response.set_content(found->second.text, "application/json");
}

void get_case_schema(Service&, const Call&, httplib::Response& response) {
  response.set_content(case_schema(), "application/schema+json");
}

void get_openapi(Service&, const Call&, httplib::Response& response) {
  response.set_content(openapi_document(), "application/yaml");
}

void get_service_info(Service& service, const Call&, httplib::Response& response) {
  Json limits = Json::object();
  for (const Setting& setting : settings_table())
    if (const auto count = std::get_if<Count Settings::*>(&setting.place))
      if (std::string_view(setting.name).starts_with("max_"))
        limits[setting.name] = service.settings.*(*count);
  response.set_content(dump({{"name", "quicksand"},
                             {"version", engine_version},
                             {"engine_build", engine_build()},
                             {"case_formats", {"quicksand.case/1"}},
                             {"started", rfc3339(service.started)},
                             {"workers", service.settings.workers},
                             {"threads_per_run", service.settings.threads_per_run},
                             {"runs",
                              {{"queued", service.store.count(RunState::queued)},
                               {"running", service.store.count(RunState::running)}}},
                             {"limits", limits}}),
                       "application/json");
}

void get_healthz(Service&, const Call&, httplib::Response& response) {
  response.set_content(R"({"status":"ok"})", "application/json");
}

void get_readyz(Service& service, const Call&, httplib::Response& response) {
  if (service.stopping) fail(503, "the server stops");
  try {
    service.store.check_writable();
  } catch (const std::exception& error) {
    spdlog::error("not ready: {}", error.what());
    fail(503, "the store cannot be written");
  }
  const std::string shortage = service.runner.shortage();
  if (!shortage.empty()) fail(503, shortage);
  response.set_content(R"({"status":"ready"})", "application/json");
}

}  // namespace quicksand

#include <algorithm>
#include <memory>

#include "server/files.hpp"
#include "server/http_problem.hpp"
#include "server/http_range.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"
#include "server/run_monitor.hpp"

namespace quicksand {
namespace {

/// Bytes held in memory per download.
constexpr std::size_t chunk_bytes = 1 << 16;
constexpr int full_downloads_retry_s = 5;  ///< s, `Retry-After` when all downloads are taken

const char* media_type(const std::string& name) {
  if (name.ends_with(".json")) return "application/json";
  if (name.ends_with(".vtkhdf")) return "application/x-hdf5";
  if (name.ends_with(".png")) return "image/png";
  return "application/octet-stream";  // .xdmf among them: text would be compressed under its strong ETag
}

/// Sends `count` bytes from `first` on, in constant memory.
void stream(Service& service, const Call& call, std::shared_ptr<const ReadOnlyFile> file, std::size_t first,
            std::size_t count, const char* type, httplib::Response& response) {
  if (count == 0) {  // the library cannot stream nothing
    response.set_content("", type);
    return;
  }
  auto place = call.request.method == "HEAD" ? nullptr : service.downloads.take();
  if (!place && call.request.method != "HEAD")
    throw ProblemError{{503,
                        "too many downloads: " + named_limit(service.settings, &Settings::max_downloads),
                        {},
                        {},
                        full_downloads_retry_s}};
  response.set_content_provider(
      count, type,
      [file, first, place = std::move(place), buffer = std::make_shared<std::vector<char>>(chunk_bytes)](
          std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        const std::size_t got = file->read(buffer->data(), std::min(length, chunk_bytes), first + offset);
        return got > 0 && sink.write(buffer->data(), got);
      });
}

StoredResult result_of(Service& service, const Call& call) {
  const StoredRun run = run_with_results(service, call);
  for (const StoredResult& result : service.store.results(run.id))
    if (result.name == call.captured.at(1)) return result;
  fail(404, is_active(run.state) ? "results are listed when the run has ended"
                                 : "no result " + call.captured.at(1));
}

/// A range counts only while the client's part is of the same file.
RangeAnswer wanted_range(const httplib::Request& request, const std::string& etag, std::uint64_t size) {
  const std::string condition = request.get_header_value("If-Range");
  if (!condition.empty() && !etag_matches(condition, etag, EtagComparison::strong)) return {};
  return parse_range(request.get_header_value("Range"), size);
}

}  // namespace

void get_run_case(Service& service, const Call& call, httplib::Response& response) {
  const StoredRun run = run_of(service, call);
  response.set_content(service.store.case_text(run.id).value_or(""), "application/json");
}

void get_run_log(Service& service, const Call& call, httplib::Response& response) {
  const StoredRun run = run_of(service, call);
  const auto path = run_log_file(service.folder, run.id);
  constexpr const char* type = "text/plain; charset=utf-8";
  if (!std::filesystem::exists(path)) return response.set_content("", type);
  const auto file = std::make_shared<const ReadOnlyFile>(path);
  stream(service, call, file, 0, file->size(), type, response);
}

void get_results(Service& service, const Call& call, httplib::Response& response) {
  const StoredRun run = run_with_results(service, call);
  response.set_content(dump(results_json(run.id, service.store.results(run.id))), "application/json");
}

void get_result_file(Service& service, const Call& call, httplib::Response& response) {
  const StoredResult result = result_of(service, call);
  const std::string etag = '"' + result.sha256 + '"';
  response.set_header("ETag", etag);
  response.set_header("Accept-Ranges", "bytes");
  if (etag_matches(call.request.get_header_value("If-None-Match"), etag, EtagComparison::weak)) {
    response.status = 304;
    response.set_header("Content-Length", std::to_string(result.bytes));
    return;
  }
  const RangeAnswer range = wanted_range(call.request, etag, result.bytes);
  if (range.kind == RangeAnswer::Kind::unsatisfiable) {
    response.set_header("Content-Range", "bytes */" + std::to_string(result.bytes));
    fail(416, "the file has " + std::to_string(result.bytes) + " bytes");
  }
  const auto path = service.folder.run(call.captured.at(0)) / result.name;
  const auto file = std::make_shared<const ReadOnlyFile>(path);
  if (range.kind == RangeAnswer::Kind::whole) {
    response.status = 200;
    return stream(service, call, file, 0, result.bytes, media_type(result.name), response);
  }
  response.status = 206;
  response.set_header("Content-Range", "bytes " + std::to_string(range.first) + "-" +
                                           std::to_string(range.last) + "/" + std::to_string(result.bytes));
  stream(service, call, file, range.first, range.last - range.first + 1, media_type(result.name), response);
}

}  // namespace quicksand

// Frames and series of a run, also while it computes.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>

#include "engine/results/result_reader.hpp"
#include "server/http_parameters.hpp"
#include "server/http_problem.hpp"
#include "server/route_handlers.hpp"
#include "server/run_json.hpp"

namespace quicksand {
namespace {

constexpr int busy_retry_s = 1;         ///< s, `Retry-After` when the results are busy
constexpr std::size_t alignment = 8;    ///< bytes, of every array in a frame
constexpr std::size_t csv_number = 24;  ///< bytes, the longest number and its comma

/// `work` on the run's results; read once more if it was caught in the middle of a write.
template <class Work>
std::string read_results(Service& service, const std::string& id, Work work) {
  for (int attempt = 0;; ++attempt) try {
      const auto reader = ResultReader::open(service.folder.run(id));
      if (!reader) fail(404, "the run has written no results yet");
      return work(*reader);
    } catch (const h5::Error&) {
      if (attempt > 0) throw ProblemError{{503, "the results are being written", {}, {}, busy_retry_s}};
    }
}

/// Keeps the place among the readers until the client has everything.
void send(std::string text, const char* type, std::shared_ptr<void> place, httplib::Response& response) {
  const auto held = std::make_shared<const std::string>(std::move(text));
  response.set_content_provider(
      held->size(), type, [held, place](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        return sink.write(held->data() + offset, length);
      });
}

std::shared_ptr<void> reader_place(Service& service) {
  auto place = service.readers.take();
  if (!place)
    throw ProblemError{{503,
                        "too many frames and series are being read: " +
                            named_limit(service.settings, &Settings::max_readers),
                        {},
                        {},
                        busy_retry_s}};
  return place;
}

void refuse_too_much(const Settings& settings, std::size_t bytes, const std::string& remedy) {
  if (bytes > static_cast<std::size_t>(settings.max_data_bytes))
    fail(400, "the answer would have " + std::to_string(bytes) + " bytes; at most " +
                  named_limit(settings, &Settings::max_data_bytes) + ": " + remedy);
}

template <class Shape>
std::string names_of(const std::vector<Shape>& shapes) {
  std::string text;
  for (const Shape& shape : shapes) text += (text.empty() ? "" : ", ") + shape.name;
  return text;
}

/// Those of `shapes` that are named, in the order of the names; what is unknown is refused.
template <class Shape>
std::vector<Shape> chosen(const std::vector<Shape>& shapes, const std::vector<std::string>& names,
                          const char* parameter) {
  std::vector<Shape> list;
  for (const std::string& name : names) {
    const auto found =
        std::find_if(shapes.begin(), shapes.end(), [&](const Shape& shape) { return shape.name == name; });
    if (found == shapes.end())
      fail(400, std::string(parameter) + ": no \"" + name + "\"; there are " + names_of(shapes));
    list.push_back(*found);
  }
  return list;
}

/// Length of the header (4 bytes, little-endian), the header as JSON, the arrays, all aligned.
std::string frame_bytes(const ResultReader& reader, std::size_t index, const FrameShape& shape,
                        const std::vector<FrameArray>& arrays, std::size_t stride) {
  const std::size_t sent = (shape.points + stride - 1) / stride;
  Json header{{"index", index},   {"time", shape.time}, {"stage", shape.stage},   {"points", shape.points},
              {"stride", stride}, {"sent", sent},       {"arrays", Json::array()}};
  std::string body;
  for (const FrameArray& array : arrays) {
    const std::string bytes = reader.array(index, array, shape.points, stride);
    header["arrays"].push_back({{"name", array.name},
                                {"type", array.type},
                                {"components", array.components},
                                {"offset", body.size()},
                                {"bytes", bytes.size()}});
    body += bytes;
    body.resize((body.size() + alignment - 1) / alignment * alignment);
  }
  std::string text = dump(header);
  text.append((2 * alignment - (text.size() + 4) % alignment) % alignment, ' ');
  const auto length = static_cast<std::uint32_t>(text.size());
  std::string answer;
  for (int shift = 0; shift < 32; shift += 8) answer += static_cast<char>(length >> shift & 0xff);
  return answer + text + body;
}

/// Every name once for each of its components: `name`, or `name[0]`, `name[1]`, …
std::string csv_head(const std::vector<SeriesShape>& list) {
  std::string text = "time [s]";
  for (const SeriesShape& series : list)
    for (std::size_t i = 0; i < series.components; ++i)
      text += "," + series.name + (series.components > 1 ? "[" + std::to_string(i) + "]" : "") +
              (series.unit.empty() ? "" : " [" + series.unit + "]");
  return text + "\n";
}

std::string number_text(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", number);
  return text.data();
}

std::string series_csv(const ResultReader& reader, const std::vector<SeriesShape>& list,
                       std::size_t samples) {
  std::vector<std::vector<double>> columns;
  for (const SeriesShape& series : list) columns.push_back(reader.values(series, samples));
  const std::vector<double> times = reader.times(list.front().name, samples);
  std::string text = csv_head(list);
  for (std::size_t k = 0; k < samples; ++k) {
    text += number_text(times[k]);
    for (std::size_t s = 0; s < list.size(); ++s)
      for (std::size_t i = 0; i < list[s].components; ++i)
        text += "," + number_text(columns[s][k * list[s].components + i]);
    text += '\n';
  }
  return text;
}

std::string series_json(const ResultReader& reader, const std::vector<SeriesShape>& list,
                        std::size_t samples) {
  Json json{{"series", Json::array()}};
  for (const SeriesShape& series : list)
    json["series"].push_back({{"name", series.name},
                              {"unit", series.unit},
                              {"components", series.components},
                              {"time", reader.times(series.name, samples)},
                              {"value", reader.values(series, samples)}});
  return dump(json);
}

std::string series_list(const std::vector<SeriesShape>& all) {
  Json json{{"series", Json::array()}};
  for (const SeriesShape& series : all)
    json["series"].push_back(
        {{"name", series.name}, {"unit", series.unit}, {"components", series.components}});
  return dump(json);
}

}  // namespace

void get_frame(Service& service, const Call& call, httplib::Response& response) {
  const StoredRun run = run_with_results(service, call);
  const auto stride = checked_number<std::size_t>(call, "stride", 1, 1'000'000, 1);
  const auto index = whole_number<std::size_t>(call.captured.at(1));
  if (!index) fail(404, "no frame " + call.captured.at(1));
  auto place = reader_place(service);
  std::string bytes = read_results(service, run.id, [&](const ResultReader& reader) {
    if (*index >= reader.frames())
      fail(404, "no frame " + call.captured.at(1) + "; so far there are " + std::to_string(reader.frames()));
    const FrameShape shape = reader.frame(*index);
    const auto arrays = call.request.has_param("fields")
                            ? chosen(shape.arrays, words(call.parameter("fields")), "fields")
                            : shape.arrays;
    std::size_t size = 0;
    for (const FrameArray& array : arrays)
      size += shape.points / stride * array.components * array.item_bytes;
    refuse_too_much(service.settings, size, "ask for fewer fields or a larger stride");
    return frame_bytes(reader, *index, shape, arrays, stride);
  });
  send(std::move(bytes), "application/octet-stream", std::move(place), response);
}

void get_series(Service& service, const Call& call, httplib::Response& response) {
  const StoredRun run = run_with_results(service, call);
  const std::string format = call.request.has_param("format") ? call.parameter("format") : "json";
  if (format != "json" && format != "csv") fail(400, "format: json or csv");
  if (format == "csv" && !call.request.has_param("name")) fail(400, "name: which series, for format=csv");
  auto place = reader_place(service);
  std::string text = read_results(service, run.id, [&](const ResultReader& reader) {
    const std::vector<SeriesShape> all = reader.series();
    if (!call.request.has_param("name")) return series_list(all);
    const std::vector<SeriesShape> list = chosen(all, words(call.parameter("name")), "name");
    std::size_t samples = SIZE_MAX, columns = 0;
    for (const SeriesShape& series : list) {
      samples = std::min(samples, reader.samples(series.name));
      columns += series.components + 1;
    }
    refuse_too_much(service.settings, samples * columns * csv_number,
                    "ask for fewer names, or read them from result.vtkhdf");
    return format == "csv" ? series_csv(reader, list, samples) : series_json(reader, list, samples);
  });
  send(std::move(text), format == "csv" ? "text/csv; charset=utf-8" : "application/json", std::move(place),
       response);
}

}  // namespace quicksand

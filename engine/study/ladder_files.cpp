// The ladder as a table and as a picture; references read from a table.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "engine/study/ladder.hpp"

namespace quicksand {
namespace {

std::string number(double value, const char* form = "%.4g") {
  char words[48];
  std::snprintf(words, sizeof words, form, value);
  return words;
}

std::string escaped(const std::string& plain) {
  std::string text;
  for (const char c : plain)
    text += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return text;
}

bool drawable(const RungResult& r) { return r.missing.empty() && r.error > 0 && r.cpu_seconds > 0; }

/// Decades that hold all values of one axis.
struct Decades {
  int low = 0, high = 1;
  double place(double value) const { return (std::log10(value) - low) / (high - low); }
};
template <class Value>
Decades decades(const std::vector<RungResult>& rungs, Value value) {
  double low = 1e300, high = 0;
  for (const RungResult& r : rungs)
    if (drawable(r)) low = std::min(low, value(r)), high = std::max(high, value(r));
  if (high == 0) return {};
  const int first = static_cast<int>(std::floor(std::log10(low)));
  return {first, std::max(first + 1, static_cast<int>(std::ceil(std::log10(high))))};
}

constexpr double kWidth = 720, kHeight = 460, kLeft = 70, kRight = 190, kTop = 40, kBottom = 55;
double x_of(double part) { return kLeft + part * (kWidth - kLeft - kRight); }
double y_of(double part) { return kHeight - kBottom - part * (kHeight - kTop - kBottom); }

std::string words_at(double x, double y, const std::string& words, const char* more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" " + more + ">" + escaped(words) + "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* colour) {
  return "<line x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" + number(x1) + "\" y2=\"" +
         number(y1) + "\" stroke=\"" + colour + "\"/>\n";
}

}  // namespace

std::string tradeoff_csv(const Tradeoff& tradeoff) {
  std::string csv = "factor,setting,error,cpu_seconds,memory_bytes,steps,point_steps,front,note\n";
  for (const RungResult& r : tradeoff.rungs) {
    const bool known = r.missing.empty();
    csv += r.factor + "," + r.setting + "," + (known && !r.reference ? number(r.error) : "") + "," +
           number(r.cpu_seconds) + "," + number(r.memory_bytes) + "," + number(r.steps, "%.0f") + "," +
           number(r.point_steps) + "," + (r.on_front ? "1" : "0") + "," +
           (r.reference ? "reference" : r.missing) + "\n";
  }
  return csv;
}

std::string tradeoff_svg(const Tradeoff& tradeoff, const std::string& title) {
  const auto cost = [](const RungResult& r) { return r.cpu_seconds; };
  const auto error = [](const RungResult& r) { return r.error; };
  const Decades along = decades(tradeoff.rungs, cost), up = decades(tradeoff.rungs, error);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(kWidth) + "\" height=\"" +
                    number(kHeight) + "\" font-family=\"sans-serif\" font-size=\"11\">\n" +
                    "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += words_at(kLeft, 22, title + ": error against " + tradeoff.reference, "font-size=\"13\"");
  for (int d = along.low; d <= along.high; ++d) {
    const double x = x_of((d - along.low) / static_cast<double>(along.high - along.low));
    svg += line(x, y_of(0), x, y_of(1), "#ddd") +
           words_at(x, y_of(0) + 16, number(std::pow(10, d)), "text-anchor=\"middle\"");
  }
  for (int d = up.low; d <= up.high; ++d) {
    const double y = y_of((d - up.low) / static_cast<double>(up.high - up.low));
    svg += line(x_of(0), y, x_of(1), y, "#ddd") +
           words_at(x_of(0) - 6, y + 4, number(std::pow(10, d)), "text-anchor=\"end\"");
  }
  svg += words_at(x_of(0.5), kHeight - 14, "CPU time, s", "text-anchor=\"middle\"");
  svg += words_at(8, kTop - 6, "error, of the range");
  std::vector<const RungResult*> front;
  for (const RungResult& r : tradeoff.rungs)
    if (drawable(r) && r.on_front) front.push_back(&r);
  std::sort(front.begin(), front.end(),
            [](const auto* a, const auto* b) { return a->cpu_seconds < b->cpu_seconds; });
  svg += "<polyline fill=\"none\" stroke=\"#c33\" points=\"";
  for (const RungResult* r : front)
    svg += number(x_of(along.place(r->cpu_seconds))) + "," + number(y_of(up.place(r->error))) + " ";
  svg += "\"/>\n";
  for (const RungResult& r : tradeoff.rungs) {
    if (!drawable(r)) continue;
    const double x = x_of(along.place(r.cpu_seconds)), y = y_of(up.place(r.error));
    svg += "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"4\" fill=\"" +
           (r.on_front ? "#c33" : "#579") + "\"/>\n" + words_at(x + 6, y + 4, r.factor + " " + r.setting);
  }
  return svg + "</svg>\n";
}

std::vector<Curve> curves_from_csv(const std::string& text) {
  std::istringstream lines(text);
  std::string row, cell;
  std::vector<Curve> curves;
  std::getline(lines, row);
  std::istringstream head(row);
  std::getline(head, cell, ',');
  if (cell != "time") throw std::runtime_error("line 1: the first column must be \"time\"");
  while (std::getline(head, cell, ',')) {
    Curve curve{cell, "", 0, {}, {}};
    if (const auto open = cell.find('['); open != std::string::npos && open + 1 < cell.size()) {
      curve.component = cell[open + 1] - '0';
      curve.name = cell.substr(0, open);
    }
    curves.push_back(curve);
  }
  for (int count = 2; std::getline(lines, row); ++count) {
    if (row.empty()) continue;
    std::istringstream cells(row);
    std::vector<double> values;
    try {
      while (std::getline(cells, cell, ',')) values.push_back(std::stod(cell));
    } catch (const std::exception&) {
      values.clear();
    }
    if (values.size() != curves.size() + 1)
      throw std::runtime_error("line " + std::to_string(count) + ": " + std::to_string(curves.size() + 1) +
                               " numbers are needed");
    for (std::size_t k = 0; k < curves.size(); ++k)
      curves[k].time.push_back(values[0]), curves[k].value.push_back(values[k + 1]);
  }
  if (curves.empty() || curves.front().time.empty()) throw std::runtime_error("holds no curves");
  return curves;
}

}  // namespace quicksand

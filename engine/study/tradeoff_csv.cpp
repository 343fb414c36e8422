// The ladder as a table, and references read from one.

#include <sstream>
#include <stdexcept>

#include "engine/scene/text.hpp"
#include "engine/study/tradeoff.hpp"

namespace quicksand {

std::string tradeoff_csv(const Tradeoff& tradeoff) {
  std::string csv = "factor,setting,error,cpu_seconds,memory_bytes,steps,point_steps,front,note\n";
  for (const RungResult& r : tradeoff.rungs) {
    const bool known = r.missing.empty();
    csv += r.factor + "," + r.setting + "," + (known && !r.reference ? text(r.error, "%.4g") : "") + "," +
           text(r.cpu_seconds, "%.4g") + "," + text(r.memory_bytes, "%.4g") + "," + text(r.steps, "%.0f") +
           "," + text(r.point_steps, "%.4g") + "," + (r.on_front ? "1" : "0") + "," +
           (r.reference ? "reference" : r.missing) + "\n";
  }
  return csv;
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

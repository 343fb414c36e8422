#include "engine/study/error_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/plan/companions.hpp"

namespace quicksand {
namespace {

/// Passes on what a companion says; its progress shows as a stage of its own.
class CompanionMonitor final : public RunMonitor {
 public:
  CompanionMonitor(RunMonitor& monitor, std::size_t frames, std::string stage)
      : monitor_(monitor), frames_(frames), stage_(std::move(stage)) {}
  void progress(const Progress& now) override {
    Progress shown = now;
    shown.stage = stage_;
    shown.frames = frames_;
    monitor_.progress(shown);
  }
  bool cancelled() override { return monitor_.cancelled() || monitor_.suspended(); }

 private:
  RunMonitor& monitor_;
  std::size_t frames_;
  std::string stage_;
};

int dimensions(const Scene& scene) { return scene.domain.dimension == Dimension::space ? 3 : 2; }

/// The headline figures as curves of one value each.
std::vector<Curve> figures_of(const Scene& scene, const RunReport& report, const HistorySink& history) {
  std::vector<Curve> all = history.curves(dimensions(scene));
  if (report.heave.empty()) return all;
  const HeaveReport& heave = report.heave.front();
  const auto add = [&](const char* name, const char* unit, double value) {
    all.push_back({std::string("headline.") + name, unit, 0, {0}, {value}});
  };
  if (heave.moved) add("time", "s", heave.time);
  add("head_difference", "m", heave.head_difference);
  add("gradient", "-", heave.gradient);
  add("final_rise", "m", heave.final_rise);
  add("max_rise", "m", heave.max_rise);
  add("max_point_displacement", "m", heave.max_point_displacement);
  return all;
}

struct OtherGrid {
  double ratio = 1;
  std::vector<Curve> curves;
  const Curve* find(const Curve& like) const {
    for (const Curve& c : curves)
      if (c.name == like.name && c.component == like.component) return &c;
    return nullptr;
  }
};

FigureError compare(const Curve& own, const std::vector<OtherGrid>& grids) {
  FigureError figure{own.name, own.unit, own.component, own.value.back(), own.range(), {}, {}};
  std::optional<GridDifference> history[2], end[2];
  double way = 1;
  for (const OtherGrid& grid : grids) {
    const Curve* other = grid.find(own);
    if (!other || other->value.empty()) continue;
    const int side = grid.ratio > 1 ? 0 : 1;
    const double last = own.value.back() - other->value.back();
    history[side] = {distance(own, *other), grid.ratio};
    end[side] = {std::abs(last), grid.ratio};
    way *= side == 0 ? last : -last;
  }
  if (!history[0] && !history[1]) return figure;
  figure.history = richardson(history[0], history[1]);
  figure.end = richardson(end[0], end[1], way >= 0);
  return figure;
}

}  // namespace

void doubt_accidents(std::vector<FigureError>& figures) {
  const auto is_inflow = [](const FigureError& f) {
    return f.unit == "m³/s" && f.range > 0 && f.name.rfind("reservoir.", 0) == 0 &&
           f.history.basis == OrderBasis::assumed;
  };
  double squares = 0;
  int count = 0;
  for (const FigureError& f : figures)
    if (is_inflow(f)) squares += f.history.error * f.history.error, ++count;
  for (FigureError& f : figures)
    if (is_inflow(f)) f.history.error = std::max(f.history.error, std::sqrt(squares / count));
}

ErrorEstimateReport estimate_error(const Scene& scene, const RunReport& report, const HistorySink& history,
                                   RunMonitor& monitor, const RunOptions& options) {
  ErrorEstimateReport estimate;
  if (report.status != RunStatus::succeeded) {
    estimate.missing = "the run did not succeed";
    return estimate;
  }
  const Companions wanted = companions(scene);
  std::vector<OtherGrid> grids;
  RunOptions plain;
  plain.threads = options.threads;
  for (const auto& companion : {wanted.coarser, wanted.finer}) {
    if (!companion) continue;
    HistorySink sink;
    const std::string stage =
        std::string("error estimate: ") + (companion->ratio > 1 ? "coarser" : "finer") + " cells";
    CompanionMonitor passing(monitor, report.frames, stage);
    monitor.log(stage);
    const RunReport other = run(companion->scene, sink, passing, plain);
    estimate.companions.push_back({companion->scene.cell_size(), companion->ratio, other.status,
                                   other.failure.message, other.steps, other.wall_seconds});
    if (other.status == RunStatus::succeeded)
      grids.push_back({companion->ratio, figures_of(companion->scene, other, sink)});
  }
  if (grids.empty()) estimate.missing = "no companion came to its end";
  if (!grids.empty())
    for (const Curve& own : figures_of(scene, report, history))
      if (!own.value.empty()) estimate.figures.push_back(compare(own, grids));
  doubt_accidents(estimate.figures);
  return estimate;
}

}  // namespace quicksand

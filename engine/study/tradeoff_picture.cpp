// The ladder as a picture: error over CPU time, both in decades, the rungs numbered by their cost.

#include <algorithm>
#include <cmath>

#include "engine/scene/text.hpp"
#include "engine/study/canvas.hpp"
#include "engine/study/tradeoff.hpp"

namespace quicksand {
namespace {

constexpr int kWidth = 880, kHeight = 460;
constexpr double kLeft = 60, kRight = 350, kTop = 44, kBottom = 48;
constexpr double kTitle = 14, kWords = 11, kRow = 17, kRadius = 4;
constexpr const char *kFront = "#cc3333", *kRest = "#557799", *kGrid = "#dddddd", *kInk = "#222222",
                     *kFaint = "#999999";

bool drawable(const RungResult& r) {
  return r.missing.empty() && !r.reference && r.error > 0 && r.cpu_seconds > 0;
}

/// Decades that hold all values of one axis.
struct Decades {
  int low = 0, high = 1;
  double place(double value) const { return (std::log10(value) - low) / (high - low); }
};
Decades decades(const std::vector<const RungResult*>& rungs, double RungResult::*value) {
  if (rungs.empty()) return {};
  const auto [least, most] = std::minmax_element(
      rungs.begin(), rungs.end(), [&](const auto* a, const auto* b) { return a->*value < b->*value; });
  const int first = static_cast<int>(std::floor(std::log10((*least)->*value)));
  return {first, std::max(first + 1, static_cast<int>(std::ceil(std::log10((*most)->*value))))};
}

Spot place(double along, double up) {
  return {kLeft + along * (kWidth - kLeft - kRight), kHeight - kBottom - up * (kHeight - kTop - kBottom)};
}

void draw_axes(Canvas& canvas, const Decades& along, const Decades& up) {
  for (int d = along.low; d <= along.high; ++d) {
    const double x = static_cast<double>(d - along.low) / (along.high - along.low);
    canvas.line(place(x, 0), place(x, 1), kGrid);
    const Spot foot = place(x, 0);
    canvas.words({foot.x, foot.y + 16}, text(std::pow(10, d), "%.3g"), kWords, Anchor::middle, kInk);
  }
  for (int d = up.low; d <= up.high; ++d) {
    const double y = static_cast<double>(d - up.low) / (up.high - up.low);
    canvas.line(place(0, y), place(1, y), kGrid);
    const Spot foot = place(0, y);
    canvas.words({foot.x - 6, foot.y + 4}, text(std::pow(10, d), "%.3g"), kWords, Anchor::end, kInk);
  }
  canvas.words({place(0.5, 0).x, kHeight - 12}, "CPU time, s", kWords, Anchor::middle, kInk);
  canvas.words({8, kTop - 8}, "error, of the largest range", kWords, Anchor::start, kInk);
}

/// Beside a point, where no other point or number stands.
Spot free_spot(Spot point, const std::vector<Spot>& taken) {
  constexpr Spot ways[] = {{6, -5}, {6, 11},  {-18, -5}, {-18, 11}, {-6, -8},   {-6, 17},
                           {12, 4}, {-26, 4}, {8, -18},  {8, 24},   {-20, -18}, {-20, 24}};
  constexpr double wide = 14, high = 10;
  for (const Spot& way : ways) {
    const Spot spot{point.x + way.x, point.y + way.y};
    const bool clear = std::none_of(taken.begin(), taken.end(), [&](const Spot& other) {
      return std::abs(other.x - spot.x) < wide && std::abs(other.y - spot.y) < high;
    });
    if (clear) return spot;
  }
  return {point.x + ways[0].x, point.y + ways[0].y};
}

void draw_points(Canvas& canvas, const std::vector<const RungResult*>& shown, const Decades& along,
                 const Decades& up) {
  std::vector<Spot> points, front;
  for (const RungResult* r : shown) {
    points.push_back(place(along.place(r->cpu_seconds), up.place(r->error)));
    if (r->on_front) front.push_back(points.back());
  }
  if (front.size() > 1) canvas.path(front, kFront);
  for (std::size_t k = 0; k < shown.size(); ++k)
    canvas.disc(points[k], kRadius, shown[k]->on_front ? kFront : kRest);
  std::vector<Spot> taken;
  for (const Spot& point : points) taken.push_back({point.x - 4, point.y + 4});  // as words stand
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const Spot spot = free_spot(points[k], taken);
    taken.push_back(spot);
    canvas.words(spot, std::to_string(k + 1), kWords, Anchor::start, kInk);
  }
}

void draw_list(Canvas& canvas, const std::vector<const RungResult*>& shown, const Tradeoff& tradeoff) {
  const double x = kWidth - kRight + 30;
  double y = kTop + 4;
  const auto row = [&](const std::string& index, const RungResult& r, const std::string& end,
                       const char* ink) {
    canvas.words({x, y}, index, kWords, Anchor::end, ink);
    canvas.words({x + 8, y}, r.factor + " " + r.setting, kWords, Anchor::start, ink);
    canvas.words({kWidth - 10, y}, end, kWords, Anchor::end, ink);
    y += kRow;
  };
  for (std::size_t k = 0; k < shown.size(); ++k)
    row(std::to_string(k + 1), *shown[k],
        text(shown[k]->error, "%.3g") + ", " + text(shown[k]->cpu_seconds, "%.3g") + " s",
        shown[k]->on_front ? kFront : kInk);
  for (const RungResult& r : tradeoff.rungs)
    if (!drawable(r))
      row("", r, r.reference ? "reference" : r.missing.empty() ? "no error" : r.missing, kFaint);
}

void draw(const Tradeoff& tradeoff, const std::string& title, Canvas& canvas) {
  std::vector<const RungResult*> shown;
  for (const RungResult& r : tradeoff.rungs)
    if (drawable(r)) shown.push_back(&r);
  std::stable_sort(shown.begin(), shown.end(),
                   [](const auto* a, const auto* b) { return a->cpu_seconds < b->cpu_seconds; });
  canvas.words({8, 20}, title + ": error against " + tradeoff.reference, kTitle, Anchor::start, kInk);
  const Decades along = decades(shown, &RungResult::cpu_seconds), up = decades(shown, &RungResult::error);
  draw_axes(canvas, along, up);
  draw_points(canvas, shown, along, up);
  draw_list(canvas, shown, tradeoff);
}

}  // namespace

std::string tradeoff_svg(const Tradeoff& tradeoff, const std::string& title) {
  const auto canvas = svg_canvas(kWidth, kHeight);
  draw(tradeoff, title, *canvas);
  return canvas->finish();
}

std::string tradeoff_png(const Tradeoff& tradeoff, const std::string& title) {
  const auto canvas = png_canvas(kWidth, kHeight);
  draw(tradeoff, title, *canvas);
  return canvas->finish();
}

}  // namespace quicksand

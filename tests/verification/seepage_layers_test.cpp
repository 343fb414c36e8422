// Steady flow up through two layers in series: q = Δh / Σ(L/k), heads linear within each layer.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// As in cases/seepage-layers.
constexpr double kBelow = 0.4305, kAbove = 0.2, kFoot = 0.02, kMiddle = 0.04, kTop = 0.16, kWidth = 0.04;
constexpr double kFilter = 1e-2, kSand = 1e-4;

double discharge() { return (kBelow - kAbove) / ((kMiddle - kFoot) / kFilter + (kTop - kMiddle) / kSand); }

double head(double y) {
  const double filter = std::clamp(y, kFoot, kMiddle) - kFoot, sand = std::clamp(y, kMiddle, kTop) - kMiddle;
  return kBelow - discharge() * (filter / kFilter + sand / kSand);
}

void layers(double cell_size_factor, const std::string& size, double flow_held_to) {
  Page page("seepage-layers", size);
  const Scene scene = load_case("seepage-layers", cell_size_factor);
  const Recorded r = page.run(scene);
  const Frame& last = r.results.frames.back();
  const auto& h = field(last, "head");
  double worst = 0;
  Curve heads{"Head over the height", "y, m", "h, m", "", {}, {}};
  for (std::size_t i = 0; i < last.points(); ++i) {
    const double y = last.position[3 * i + 1];
    heads.x.push_back(y), heads.result.push_back(h[i]), heads.reference.push_back(head(y));
    // Within a cell of a jump of permeability the head is interpolated across it.
    const double from_jump = std::min({std::abs(y - kFoot), std::abs(y - kMiddle), std::abs(y - kTop)});
    if (from_jump > scene.cell_size()) worst = std::max(worst, std::abs(h[i] - head(y)) / (kBelow - kAbove));
  }
  page.curve(heads);
  page.near("flow", r.results.last("section.mid"), discharge() * kWidth, flow_held_to, "m³/s per metre");
  page.error("head, more than a cell from the layers' faces", worst, 0.005, "of the difference");
}

TEST(SeepageLayers, LayersResistByTheirThickness) {
  layers(2, "10 mm cells", 0.005);
  layers(1, "5 mm cells", 0.005);
}

}  // namespace
}  // namespace quicksand::test

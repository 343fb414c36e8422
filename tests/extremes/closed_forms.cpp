// Invariants that compare: with a closed form, with other threads, with the scene at another scale.

#include <cmath>

#include "tests/extremes/invariants.hpp"

namespace quicksand::test {
namespace {

/// Pressure of water at rest; 1 % of the deepest, twice what cases/hydrostatic is held to: its cells are
/// finer.
void check_hydrostatic(const Scene& s, const Recorder& results, Broken& broken) {
  // The level of the water that was seeded: a tank's edge between two rows of points is moved to one.
  double top = s.domain.min[1];
  const Frame& first = results.frames.front();
  for (std::size_t i = 0; i < first.points(); ++i)
    if (first.phase[i] == 1) top = std::max(top, first.position[3 * i + 1]);
  top += 0.5 * s.cell_size() / s.numerics.points_per_cell;
  const double weight = s.water.density * -s.gravity[1];
  double worst = 0;
  for (const Frame& frame : results.frames) {
    const auto& p = field(frame, "pore_pressure");
    for (std::size_t i = 0; i < frame.points(); ++i)
      if (frame.phase[i] == 1)
        worst = std::max(worst, std::abs(p[i] - weight * (top - frame.position[3 * i + 1])));
  }
  const double off = worst / (weight * (top - s.domain.min[1]));
  if (off > 0.01) broken.push_back("hydrostatic pressure off by " + figure(off));
}

/// The way of the middle of mass, ½ g t²; symplectic steps are off by ½ g t Δt. Until the floor is in reach
/// of the kernels.
void check_fall(const Scene& s, const RunReport& report, const Recorder& results, Broken& broken) {
  double start = 0, low = 0;
  for (const Frame& frame : results.frames) {
    double middle = 0, lowest = 1e300;
    for (std::size_t i = 0; i < frame.points(); ++i) {
      middle += frame.position[3 * i + 1] / static_cast<double>(frame.points());
      lowest = std::min(lowest, frame.position[3 * i + 1]);
    }
    if (frame.index == 0) start = middle, low = lowest;
    const double way = 0.5 * -s.gravity[1] * frame.time * frame.time;
    if (low - way < s.domain.min[1] + 2 * s.cell_size()) return;
    const double allowed =
        0.5 * -s.gravity[1] * frame.time * report.time_step_max + 1e-6 * way + 1e-9 * s.cell_size();
    if (std::abs(start - middle - way) > allowed)
      return broken.push_back("fell " + figure(start - middle) + " m of " + figure(way));
  }
}

double factor(const std::string& unit, double l, double t, Dimension dimension) {
  const double depth = dimension == Dimension::plane_strain ? 1 : l, speed = l / t;
  if (unit == "m") return l;
  if (unit == "m/s") return speed;
  if (unit == "Pa") return speed * speed;
  if (unit == "s") return t;
  if (unit == "m³") return l * l * depth;
  if (unit == "kg") return l * l * depth;
  if (unit == "N·s") return l * l * depth * speed;
  if (unit == "J") return l * l * depth * speed * speed;
  if (unit == "m³/s") return l * depth * speed;
  if (unit == "N") return l * depth * speed * speed;
  return 1;
}

}  // namespace

void check_form(const Scene& scene, const std::string& form, const RunReport& report, const Recorder& results,
                Broken& broken) {
  if (form == "hydrostatic") check_hydrostatic(scene, results, broken);
  if (form == "fall") check_fall(scene, report, results, broken);
}

void check_same(const Recorder& one, const Recorder& other, Broken& broken) {
  bool same =
      one.times == other.times && one.rows() == other.rows() && one.frames.size() == other.frames.size();
  for (std::size_t k = 0; same && k < one.frames.size(); ++k) {
    same = one.frames[k].position == other.frames[k].position;
    for (std::size_t f = 0; same && f < one.frames[k].fields.size(); ++f)
      same = one.frames[k].fields[f].values == other.frames[k].fields[f].values;
  }
  if (!same) broken.push_back("another result on 3 threads");
}

void check_similar(const Scene& scene, const Recorder& base, const Recorder& other, double length,
                   double time, Broken& broken) {
  constexpr double kAgree = 1e-8;  // the issue's
  if (base.frames.size() != other.frames.size() || base.rows().size() != other.rows().size())
    return broken.push_back("similar scene: other frames");
  for (std::size_t k = 0; k < base.frames.size(); ++k) {
    const Frame &a = base.frames[k], &b = other.frames[k];
    if (a.points() != b.points()) return broken.push_back("similar scene: other points");
    for (std::size_t i = 0; i < a.position.size(); ++i)
      if (const double off = std::abs(a.position[i] - b.position[i] / length) / scene.cell_size();
          off > kAgree)
        return broken.push_back("similar scene: position off by " + figure(off) + " cells in frame " +
                                std::to_string(k));
  }
  std::size_t column = 0;
  for (const SeriesInfo& info : base.info())
    for (int c = 0; c < info.components; ++c, ++column) {
      // Momenta and forces that cancel are rounding, and so is what is compared with them; energies do not.
      if (info.unit != "J" && info.unit != "Pa" && info.unit != "m³") continue;
      double largest = 0, off = 0;
      const double by = factor(info.unit, length, time, scene.domain.dimension);
      for (std::size_t row = 0; row < base.rows().size(); ++row) {
        largest = std::max(largest, std::abs(base.rows()[row][column]));
        off = std::max(off, std::abs(base.rows()[row][column] - other.rows()[row][column] / by));
      }
      if (info.unit == "J") largest = std::max(largest, base.last("ledger.energy"));
      if (off > kAgree * largest)
        return broken.push_back("similar scene: " + info.name + " off by " + figure(off / largest));
    }
}

}  // namespace quicksand::test

// G. Lamé's elastic tube under pressure, about its axis: σrr = A − B/r², σθθ = A + B/r² with
// A = (pi a² − po b²)/(b² − a²), B = (pi − po) a² b²/(b² − a²), u = ((1−2ν) A r + B/r)(1+ν)/E in plane
// strain.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/book.hpp"

namespace quicksand::test {
namespace {

// As in cases/lame.
constexpr double kInner = 1, kOuter = 2, kInside = 2e3, kOutside = 1e3, kYoung = 1e7, kPoisson = 0.3;
constexpr double kRing = kOuter * kOuter - kInner * kInner;
constexpr double kA = (kInside * kInner * kInner - kOutside * kOuter * kOuter) / kRing;
constexpr double kB = (kInside - kOutside) * kInner * kInner * kOuter * kOuter / kRing;

double displacement(double r) { return (1 + kPoisson) / kYoung * ((1 - 2 * kPoisson) * kA * r + kB / r); }

struct Errors {
  double displacement = 0, radial = 0, hoop = 0, axial = 0;
};

/// Largest differences over all points of the last frame.
Errors tube(int cells, double held_to) {
  Page page("lame", std::to_string(cells) + " cells");
  const Recorded r = page.run(load_case("lame", 20.0 / cells));
  const Frame& last = r.results.frames.back();
  const auto& u = field(last, "displacement");
  const auto& s = field(last, "effective_stress");
  Errors e;
  Curve moved{"Radial displacement", "r, m", "u, mm", "", {}, {}},
      radial{"Radial stress", "r, m", "σrr, Pa", "", {}, {}},
      hoop{"Hoop stress", "r, m", "σθθ, Pa", "", {}, {}};
  for (std::size_t i = 0; i < last.points(); ++i) {
    const double at = last.position[3 * i] - u[3 * i];
    const double srr = kA - kB / (at * at), stt = kA + kB / (at * at), szz = 2 * kPoisson * kA;
    e.displacement = std::max(e.displacement, std::abs(u[3 * i] - displacement(at)));
    e.radial = std::max(e.radial, std::abs(s[4 * i] - srr));
    e.hoop = std::max(e.hoop, std::abs(s[4 * i + 2] - stt));
    e.axial = std::max(e.axial, std::abs(s[4 * i + 1] - szz));
    if (last.position[3 * i + 1] > kInner / cells / 2) continue;  // the lowest row stands for all
    moved.x.push_back(at), moved.result.push_back(1e3 * u[3 * i]);
    moved.reference.push_back(1e3 * displacement(at));
    radial.x.push_back(at), radial.result.push_back(s[4 * i]), radial.reference.push_back(srr);
    hoop.x.push_back(at), hoop.result.push_back(s[4 * i + 2]), hoop.reference.push_back(stt);
  }
  e.displacement /= displacement(kInner);
  e.radial /= kInside, e.hoop /= kInside, e.axial /= kInside;
  page.curve(moved), page.curve(radial), page.curve(hoop);
  page.error("displacement", e.displacement, held_to, "of that inside");
  page.error("radial stress", e.radial, held_to, "of the pressure inside");
  page.error("hoop stress", e.hoop, held_to, "of the pressure inside");
  page.error("axial stress", e.axial, held_to, "of the pressure inside");
  return e;
}

TEST(Lame, ConvergesToTheTubesStress) {
  tube(5, 0.01);
  tube(10, 0.01);
  tube(20, 0.01);
}

TEST(SlowLame, FineCells) { tube(40, 0.01); }

}  // namespace
}  // namespace quicksand::test

// Element tests: one point of every material along triaxial, shear and compression paths, its stress from the
// engine's update against constitutive equations integrated independently (constitutive_reference.hpp).

#include <gtest/gtest.h>

#include <cmath>

#include "engine/materials/soil_material.hpp"
#include "tests/verification/book.hpp"
#include "tests/verification/constitutive_reference.hpp"

namespace quicksand::test {
namespace {

constexpr double kPorosity = 0.5, kConfinement = 1e5;  // –, Pa
constexpr double kHeldTo = 1e-3;
constexpr double kStrain = 0.05;  // at the end of a path
constexpr int kSteps = 5000;      // of the engine: 1e-5 of strain, as in its runs
constexpr int kSubsteps = 4;      // of the reference in each

SoilModel elastic() { return {.young_modulus = 1e7, .poisson_ratio = 0.3}; }
SoilModel mohr_coulomb() {
  return {.law = SoilLaw::mohr_coulomb,
          .young_modulus = 2e7,
          .poisson_ratio = 0.3,
          .friction_angle = 30,
          .dilation_angle = 8,
          .cohesion = 1e4};
}
SoilModel undrained_clay() {
  return {.law = SoilLaw::mohr_coulomb, .young_modulus = 2e7, .poisson_ratio = 0.49, .cohesion = 2e4};
}
SoilModel softening() {
  SoilModel m = mohr_coulomb();
  m.cohesion = 4e4, m.residual_cohesion = 1e4, m.softening_strain = 0.04;
  return m;
}
SoilModel cutoff() {
  SoilModel m = mohr_coulomb();
  m.cohesion = 2e5, m.tension_cutoff = 5e3;
  return m;
}
SoilModel cam_clay(double ocr) {
  return {.law = SoilLaw::modified_cam_clay,
          .poisson_ratio = 0.25,
          .compression_slope = 0.2,
          .swelling_slope = 0.04,
          .critical_state_slope = 1.1,
          .over_consolidation_ratio = ocr};
}

/// A path: increments of strain (xx yy zz xy) and spin per unit of its parameter. Drained triaxial tests find
/// their lateral strain from constant lateral stress.
struct Path {
  const char* name;
  Four strain;
  double spin = 0;
  bool drained = false;
};
const Path kPaths[] = {
    {"triaxial compression, drained", {0, -1, 0, 0}, 0, true},
    {"triaxial extension, drained", {0, 1, 0, 0}, 0, true},
    {"triaxial compression, undrained", {0.5, -1, 0.5, 0}},
    {"triaxial extension, undrained", {-0.5, 1, -0.5, 0}},
    {"simple shear", {0, 0, 0, 0.5}, 0.5},
    {"oedometer", {0, -1, 0, 0}},
    {"isotropic", {-1.0 / 3, -1.0 / 3, -1.0 / 3, 0}},
};

/// Lateral strain that leaves `lateral_stress(strain)` as it is: secant, exact where the response is linear.
template <class F>
double drained_strain(double guess, double scale, F&& lateral_stress) {
  double a = guess, fa = lateral_stress(a), b = guess + scale, fb = lateral_stress(b);
  for (int i = 0; i < 50 && std::abs(fb) > 1e-9 * kConfinement && fa != fb; ++i) {
    const double next = b - fb * (b - a) / (fb - fa);
    a = b, fa = fb, b = next, fb = lateral_stress(b);
  }
  return b;
}

struct EnginePoint {
  SoilMaterial material;
  SoilState<2> state;
  double porosity = kPorosity;
  Four stress() const { return {state.stress[0], state.stress[1], state.stress[2], state.stress[3]}; }
  void strain(const Four& e, double spin) {
    Gradient<2> l{};
    l[0] = {e[0], e[3] + spin}, l[1] = {e[3] - spin, e[1]};
    EXPECT_EQ(update_state<2>(material, state, porosity, l, 1, e[2]), 0);
    porosity = 1 - (1 - porosity) / (1 + e[0] + e[1] + e[2]);
  }
};

/// One step of a path; keeps the lateral strain of the last as a guess.
template <class Point>
void follow(Point& point, const Path& path, double step, double& lateral) {
  Four e = step * path.strain;
  if (path.drained) {
    lateral = drained_strain(lateral, 0.1 * step, [&](double x) {
      Point trial = point;
      trial.strain({x, e[1], x, 0}, 0);
      return trial.stress_xx() + kConfinement;
    });
    e[0] = e[2] = lateral;
  }
  point.strain(e, step * path.spin);
}

struct DrivenEngine : EnginePoint {
  double stress_xx() const { return state.stress[0]; }
};
struct DrivenReference : ReferencePoint {
  double stress_xx() const { return stress[0]; }
};

struct PathCurves {
  std::vector<double> strain, q, q_reference;
};

/// Largest difference of p, q and the void ratio along the path, of the largest stress and change of e.
double largest_error(const SoilModel& model, const Path& path, PathCurves* curves = nullptr) {
  Soil soil;
  soil.porosity = kPorosity, soil.model = model;
  DrivenEngine engine;
  engine.material = SoilMaterial::from(soil, {});
  engine.state.stress = {-kConfinement, -kConfinement, -kConfinement, 0};
  EXPECT_EQ(engine.material.begin(engine.state), 0);
  DrivenReference reference;
  reference.model = model;
  reference.stress = Four(-1, -1, -1, 0) * kConfinement;
  reference.void_ratio = kPorosity / (1 - kPorosity);
  if (reference.cam_clay()) reference.hardening = model.over_consolidation_ratio * kConfinement;

  double worst = 0, largest = kConfinement, change = kStrain, lateral = 0, lateral_reference = 0;
  for (int i = 1; i <= kSteps; ++i) {
    follow(engine, path, kStrain / kSteps, lateral);
    for (int k = 0; k < kSubsteps; ++k)
      follow(reference, path, kStrain / kSteps / kSubsteps, lateral_reference);
    const Four s = engine.stress(), r = reference.stress;
    const double e = engine.porosity / (1 - engine.porosity);
    largest = std::max({largest, mean_pressure(r), von_mises(r)});
    change = std::max(change, std::abs(reference.void_ratio - 1));
    worst = std::max(
        {worst, (s - r).cwiseAbs().maxCoeff() / largest, std::abs(e - reference.void_ratio) / change});
    if (curves && i % 50 == 0) {
      curves->strain.push_back(kStrain * i / kSteps);
      curves->q.push_back(von_mises(s) / kConfinement),
          curves->q_reference.push_back(von_mises(r) / kConfinement);
    }
  }
  return worst;
}

void element_page(const char* name, const SoilModel& model, std::initializer_list<int> shown) {
  Page page("element-tests", name);
  int index = 0;
  for (const Path& path : kPaths) {
    PathCurves c;
    page.error(path.name, largest_error(model, path, &c), kHeldTo, "of the largest");
    if (std::find(shown.begin(), shown.end(), index++) != shown.end())
      page.curve({path.name, "strain", "q / confinement", "", c.strain, c.q, c.q_reference});
  }
}

TEST(ElementTests, LinearElastic) { element_page("linear elastic", elastic(), {0}); }
TEST(ElementTests, MohrCoulomb) { element_page("Mohr–Coulomb", mohr_coulomb(), {0, 1, 4}); }
TEST(ElementTests, CohesiveWithoutFriction) { element_page("Mohr–Coulomb, φ = 0", undrained_clay(), {0}); }
TEST(ElementTests, SofteningCohesion) { element_page("Mohr–Coulomb, softening", softening(), {0, 4}); }
TEST(ElementTests, TensionCutoff) { element_page("Mohr–Coulomb, tension cut-off", cutoff(), {1}); }
TEST(ElementTests, CamClayNormallyConsolidated) { element_page("Cam-Clay, OCR 1", cam_clay(1), {0, 2, 4}); }
TEST(ElementTests, CamClayOverConsolidated) { element_page("Cam-Clay, OCR 4", cam_clay(4), {0, 2, 4}); }

/// The case: the whole engine takes every point of a block along the path of the oedometer. Compared at each
/// point's own void ratio, for all frames.
TEST(ElementTests, BlockInTheEngine) {
  Page page("element-tests", "Cam-Clay block in the engine");
  const Scene scene = load_case("element-tests");
  const Recorded r = page.run(scene);
  ReferencePoint reference;
  reference.model = scene.soils.at("clay").model;
  reference.stress = Four(-1, -1, -1, 0) * kConfinement;
  reference.hardening = reference.model.over_consolidation_ratio * kConfinement;
  std::vector<double> e, vertical, lateral;  // along the path
  for (int i = 0; i < 30000; ++i) {
    e.push_back(reference.void_ratio), vertical.push_back(-reference.stress[1]);
    lateral.push_back(-reference.stress[0]);
    reference.strain({0, -1e-5, 0, 0});
  }
  double worst = 0, pressed = 0;
  PathCurves curve;
  for (const Frame& frame : r.results.frames) {
    const auto &stress = field(frame, "effective_stress"), &porosity = field(frame, "porosity");
    for (std::size_t p = 0; p < frame.points(); ++p) {
      const double ratio = porosity[p] / (1 - porosity[p]);
      const auto at = std::lower_bound(e.begin(), e.end(), ratio, std::greater<>()) - e.begin();
      ASSERT_LT(static_cast<std::size_t>(at), e.size());
      worst = std::max({worst, std::abs(-stress[4 * p + 1] - vertical[at]) / vertical[at],
                        std::abs(-stress[4 * p] - lateral[at]) / lateral[at]});
      pressed = std::max(pressed, -stress[4 * p + 1] / kConfinement);
      if (p == 0) {
        curve.strain.push_back(1 - (1 + ratio) / 2), curve.q.push_back(-stress[1] / kConfinement);
        curve.q_reference.push_back(vertical[at] / kConfinement);
      }
    }
  }
  EXPECT_GT(pressed, 2.8);  // it went the whole way
  page.error("stress at the point's void ratio", worst, kHeldTo, "–");
  page.curve({"block, oedometer", "strain", "vertical stress / confinement", "", curve.strain, curve.q,
              curve.q_reference});
}

}  // namespace
}  // namespace quicksand::test

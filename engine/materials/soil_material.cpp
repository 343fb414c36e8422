#include "engine/materials/soil_material.hpp"

namespace quicksand {
namespace {

/// f(L{}) with the law that the model names.
template <class F>
auto with_named_law(const SoilModel& model, F&& f) {
  switch (model.law) {
    case SoilLaw::mohr_coulomb:
      return f(MohrCoulombLaw{});
    case SoilLaw::modified_cam_clay:
      return f(CamClayLaw{});
    case SoilLaw::linear_elastic:
      break;
  }
  return f(LinearElasticLaw{});
}

}  // namespace

SoilMaterial SoilMaterial::from(const Soil& soil, const Water& water, double usual_stress) {
  SoilMaterial m;
  m.law = with_named_law(soil.model, [&](auto law) { return Law(decltype(law)::from(soil.model)); });
  if (auto* clay = std::get_if<CamClayLaw>(&m.law))
    clay->least_pressure = CamClayLaw::kLeastPart * usual_stress;
  m.drag = Drag::from(soil, water);
  m.grain_density = soil.grain_density;
  m.porosity = soil.porosity;
  m.max_porosity = soil.max_porosity.value_or(1);
  m.shear_share = (1 - 2 * soil.model.poisson_ratio) / (2 * (1 - soil.model.poisson_ratio));
  m.k0 = soil.k0;
  return m;
}

ModelFaults check_model(const SoilModel& model) {
  ModelFaults faults;
  with_named_law(model, [&](auto law) { decltype(law)::check(model, faults); });
  return faults;
}

bool needs_initial_stress(const SoilModel& model) {
  return with_named_law(model, [](auto law) { return law.kNeedsStress; });
}

}  // namespace quicksand

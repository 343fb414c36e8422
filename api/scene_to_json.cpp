#include "api/scene_to_json.hpp"

#include "api/words.hpp"
#include "engine/scene/stages.hpp"

namespace quicksand {
namespace {

using Json = nlohmann::ordered_json;

/// What decides how a value is written and whether it has an effect.
struct Writer {
  const Scene& scene;
  const std::size_t dimensions = scene.domain.dimension == Dimension::space ? 3 : 2;
  const bool water = has_water(scene), soil = has_soil(scene);

  Json vector(const Vec3& value) const {
    return std::vector<double>(value.begin(), value.begin() + static_cast<std::ptrdiff_t>(dimensions));
  }
  Json segment(const Segment& line) const { return {{"from", vector(line.from)}, {"to", vector(line.to)}}; }

  Json region(const Region& r) const;
  Json domain() const;
  Json soil_of(const Soil& s) const;
  Json model(const SoilModel& m) const;
  Json materials() const;
  Json body(const Body& b) const;
  Json wall(const Wall& w) const;
  Json initial() const;
  Json load(const Load& l) const;
  Json stage(const Stage& s) const;
  Json output() const;
  Json numerics() const;
};

Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

template <typename Items, typename Write>
Json list(const Items& items, const Write& write) {
  Json all = Json::array();
  for (const auto& item : items) all.push_back(write(item));
  return all;
}

Json Writer::region(const Region& r) const {
  const auto nested = [this](const Region& part) { return region(part); };
  switch (r.kind) {
    case Region::Kind::box:
      return {{"box", {{"min", vector(r.min)}, {"max", vector(r.max)}}}};
    case Region::Kind::polygon:
      return {{"polygon", r.vertices}};
    case Region::Kind::disc:
      return {{"disc", {{"center", {r.center[0], r.center[1]}}, {"radius", r.radius}}}};
    case Region::Kind::union_of:
      return {{"union", list(r.parts, nested)}};
    case Region::Kind::difference:
      return {{"difference", list(r.parts, nested)}};
  }
  return nullptr;
}

Json Writer::domain() const {
  const Domain& d = scene.domain;
  Json sides = Json::object();
  for (std::size_t k = 0; k < 2 * dimensions; ++k) sides[side_words[k]]["kind"] = word_of(d.sides[k].kind);
  return {{"dimension", word_of(d.dimension)},
          {"min", vector(d.min)},
          {"max", vector(d.max)},
          {"cell_size", d.cell_size},
          {"sides", sides}};
}

Json Writer::soil_of(const Soil& s) const {
  Json json{{"grain_density", s.grain_density},
            {"porosity", s.porosity},
            {"max_porosity", optional(s.max_porosity)}};
  if (water) {
    const bool ergun = s.permeability.law == PermeabilityLaw::ergun;
    json["permeability"] = {{"law", word_of(s.permeability.law)}};
    json["permeability"][ergun ? "grain_size" : "value"] =
        ergun ? s.permeability.grain_size : s.permeability.value;
    if (s.permeability.law == PermeabilityLaw::power)
      json["permeability"]["exponent"] = s.permeability.exponent;
  }
  if (scene.initial.stress == InitialStress::k0) json["k0"] = optional(s.k0);
  json["model"] = model(s.model);
  return json;
}

Json Writer::model(const SoilModel& m) const {
  Json json{{"law", word_of(m.law)}};
  if (m.law != SoilLaw::modified_cam_clay) json["young_modulus"] = m.young_modulus;
  json["poisson_ratio"] = m.poisson_ratio;
  if (m.law == SoilLaw::mohr_coulomb) {
    json["friction_angle"] = m.friction_angle;
    json["dilation_angle"] = m.dilation_angle;
    json["cohesion"] = m.cohesion;
    json["tension_cutoff"] = optional(m.tension_cutoff);
    json["residual_cohesion"] = optional(m.residual_cohesion);
    if (m.residual_cohesion) json["softening_strain"] = m.softening_strain;
  }
  if (m.law == SoilLaw::modified_cam_clay) {
    json["compression_slope"] = m.compression_slope;
    json["swelling_slope"] = m.swelling_slope;
    json["critical_state_slope"] = m.critical_state_slope;
    json["over_consolidation_ratio"] = m.over_consolidation_ratio;
  }
  return json;
}

Json Writer::materials() const {
  Json json{{"soils", Json::object()}};
  for (const auto& [name, s] : scene.soils) json["soils"][name] = soil_of(s);
  if (water) {
    json["water"] = {{"density", scene.water.density}};
    json["water"]["bulk_modulus"] =
        scene.water.bulk_modulus ? Json(*scene.water.bulk_modulus) : Json("incompressible");
    json["water"]["viscosity"] = scene.water.viscosity;
  }
  return json;
}

Json Writer::body(const Body& b) const {
  Json json{{"name", b.name}, {"kind", word_of(b.kind)}};
  if (b.kind != BodyKind::water) json["soil"] = b.soil;
  json["region"] = region(b.region);
  if (b.kind != BodyKind::water) json["fixed"] = b.fixed;
  if (!b.fixed) {
    json["velocity"] = vector(b.velocity);
    if (scene.domain.dimension != Dimension::axisymmetric) json["rotation_rate"] = b.rotation_rate;
  }
  return json;
}

Json Writer::wall(const Wall& w) const {
  Json json{{"name", w.name}};
  if (w.block) json["block"] = region(*w.block);
  if (w.line) json["line"] = segment(*w.line);
  json["no_slip"] = w.no_slip;
  return json;
}

Json Writer::initial() const {
  const Initial& i = scene.initial;
  Json json = Json::object();
  if (water) {
    json["pressure"] = word_of(i.pressure);
    if (i.pressure == InitialPressure::hydrostatic) json["water_table"] = optional(i.water_table);
    if (i.pressure == InitialPressure::uniform) json["uniform_pressure"] = i.uniform_pressure;
  }
  if (soil) {
    json["stress"] = word_of(i.stress);
    if (i.stress == InitialStress::k0) json["k0"] = optional(i.k0);
    if (i.stress == InitialStress::uniform)
      json["uniform_stress"] =
          std::vector<double>(i.uniform_stress.begin(), i.uniform_stress.begin() + (dimensions == 3 ? 6 : 4));
  }
  return json;
}

Json Writer::load(const Load& l) const {
  Json json{{"name", l.name}, {"kind", word_of(l.kind)}, {"body", l.body}};
  if (l.kind == Load::Kind::traction) {
    json["side"] = word_of(l.side);
    json["traction"] = vector(l.traction);
  } else {
    json["plate"] = segment(l.plate);
    if (l.plate_force)
      json["plate_force"] = vector(*l.plate_force);
    else
      json["plate_velocity"] = vector(l.plate_velocity);
    json["rough"] = l.rough;
  }
  json["ramp"] = l.ramp;
  return json;
}

Json Writer::stage(const Stage& s) const {
  Json json{{"name", s.name}, {"duration", s.duration}};
  if (s.until_rest)
    json["until_rest"] = {{"speed", s.until_rest->speed}, {"at_least", s.until_rest->at_least}};
  json["open_gates"] = s.open_gates;
  json["heads"] = Json(s.heads);
  if (s.heads.empty())
    json["heads"] = Json::object();
  else
    json["heads_ramp"] = s.heads_ramp;
  json["loads"] = s.loads ? Json(*s.loads) : Json(nullptr);
  json["remove_bodies"] = s.remove_bodies;
  if (soil) {
    json["damping"] = s.damping;
    json["quasi_static"] = s.quasi_static;
  }
  return json;
}

Json Writer::output() const {
  const Output& o = scene.output;
  Json json{
      {"frame_interval", o.frame_interval}, {"series_interval", o.series_interval}, {"fields", o.fields}};
  json["probes"] = list(o.probes, [this](const Probe& p) {
    return Json{{"name", p.name}, {"at", vector(p.at)}, {"quantity", p.quantity}};
  });
  json["sections"] = list(o.sections, [this](const Section& s) {
    return Json{{"name", s.name}, {"line", segment(s.line)}, {"quantity", s.quantity}};
  });
  if (o.heave)
    json["heave"] = {{"body", o.heave->body},
                     {"threshold", o.heave->threshold},
                     {"below", o.heave->below},
                     {"above", o.heave->above}};
  return json;
}

Json Writer::numerics() const {
  const Numerics& n = scene.numerics;
  Json json{{"preset", word_of(n.preset)},
            {"cell_size_factor", n.cell_size_factor},
            {"points_per_cell", n.points_per_cell},
            {"kernel", word_of(n.kernel)},
            {"transfer", word_of(n.transfer)}};
  if (n.transfer == Transfer::flip) json["pic_rate"] = n.pic_rate;
  if (water) {
    json["pressure"] = word_of(n.pressure);
    if (n.pressure == PressureScheme::implicit) json["pressure_tolerance"] = n.pressure_tolerance;
    json["drift_time"] = n.drift_time;
  }
  json["time_step"] = optional(n.time_step);
  if (!n.time_step) json["time_step_factor"] = n.time_step_factor;
  if (has_quasi_static(scene)) json["quasi_static_transits"] = n.quasi_static_transits;
  json["max_steps"] = n.max_steps;
  json["error_estimate"] = n.error_estimate == ErrorEstimate::finer
                               ? Json("finer")
                               : Json(n.error_estimate == ErrorEstimate::coarser);
  json["target_error"] = optional(n.target_error);
  json["budget_seconds"] = optional(n.budget_seconds);
  json["chosen"] = n.chosen.empty() ? Json(nullptr) : Json(n.chosen);
  return json;
}

}  // namespace

nlohmann::ordered_json scene_to_json(const Scene& scene) {
  const Writer w{scene};
  Json json{{"schema", "quicksand.case/1"}, {"name", scene.name}, {"description", scene.description}};
  json["domain"] = w.domain();
  json["gravity"] = w.vector(scene.gravity);
  json["materials"] = w.materials();
  json["bodies"] = list(scene.bodies, [&](const Body& b) { return w.body(b); });
  json["walls"] = list(scene.walls, [&](const Wall& wall) { return w.wall(wall); });
  json["gates"] = list(scene.gates, [&](const Gate& g) {
    return Json{{"name", g.name}, {"line", w.segment(g.line)}};
  });
  json["reservoirs"] = list(scene.reservoirs, [&](const Reservoir& r) {
    return Json{{"name", r.name}, {"line", w.segment(r.line)}, {"head", r.head}};
  });
  json["initial"] = w.initial();
  json["loads"] = list(scene.loads, [&](const Load& l) { return w.load(l); });
  json["stages"] = list(scene.stages, [&](const Stage& s) { return w.stage(s); });
  json["output"] = w.output();
  json["numerics"] = w.numerics();
  return json;
}

}  // namespace quicksand

#pragma once
// What points leave on the faces: sums over points, per face, not per volume. Kept in pairs that are summed
// together, so that four faces in a row are one vector, and only those that a scene asks for.

#include <cstddef>

#include "engine/grid/field.hpp"

namespace quicksand {

/// Of one phase.
struct alignas(16) MassSum {
  double mass = 0;      ///< kg
  double momentum = 0;  ///< kg·m/s
};
/// On the grains.
struct alignas(16) ForceSum {
  double resistivity = 0;  ///< N·s/m, bulk volume × ρw g/k
  double force = 0;        ///< N, of the effective stress
};
/// Of the grains.
struct alignas(16) RoomSum {
  double grains = 0;  ///< m³
  double bulk = 0;    ///< m³, grains and pores
};

/// All of a face; zeros for what is not kept.
struct FaceSums {
  double soil_mass = 0, grains = 0, soil_bulk = 0, soil_momentum = 0, soil_force = 0, resistivity = 0;
  double water_mass = 0, water_momentum = 0;
};

/// Of the faces of one component.
struct FaceSumFields {
  Field<MassSum> soil, water;
  Field<ForceSum> force;  ///< with `soil` where there is water
  Field<double> stress;   ///< N, with `soil` where there is none: ForceSum::force, as nothing resists
  Field<RoomSum> room;    ///< with `force`

  FaceSumFields() = default;
  FaceSumFields(std::size_t faces, bool has_soil, bool has_water)
      : soil(has_soil ? faces : 0),
        water(has_water ? faces : 0),
        force(has_soil && has_water ? faces : 0),
        stress(has_soil && !has_water ? faces : 0),
        room(has_soil && has_water ? faces : 0) {}

  FaceSums operator[](int face) const {
    FaceSums all;
    if (!soil.empty()) all.soil_mass = soil[face].mass, all.soil_momentum = soil[face].momentum;
    if (!stress.empty()) all.soil_force = stress[face];
    if (!force.empty()) {
      all.resistivity = force[face].resistivity, all.soil_force = force[face].force;
      all.grains = room[face].grains, all.soil_bulk = room[face].bulk;
    }
    if (!water.empty()) all.water_mass = water[face].mass, all.water_momentum = water[face].momentum;
    return all;
  }
  void set_soil(int face, const FaceSums& all) {
    if (soil.empty()) return;
    soil[face] = {all.soil_mass, all.soil_momentum};
    if (!stress.empty()) stress[face] = all.soil_force;
    if (force.empty()) return;
    force[face] = {all.resistivity, all.soil_force};
    room[face] = {all.grains, all.soil_bulk};
  }
  /// N, on the grains.
  void add_force(int face, double f) { (stress.empty() ? force[face].force : stress[face]) += f; }
  void clear(std::size_t face) {
    each([&](auto& field) { field[face] = {}; });
  }
  /// f(field) for those that are kept.
  template <class F>
  void each(F&& f) {
    each_of(*this, f);
  }
  template <class F>
  void each(F&& f) const {
    each_of(*this, f);
  }

 private:
  template <class Fields, class F>
  static void each_of(Fields& fields, F&& f) {
    if (!fields.soil.empty()) f(fields.soil);
    if (!fields.stress.empty()) f(fields.stress);
    if (!fields.force.empty()) f(fields.force), f(fields.room);
    if (!fields.water.empty()) f(fields.water);
  }
};

}  // namespace quicksand

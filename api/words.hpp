#pragma once
// The words of a case file for the choices of a scene. One table per choice; first is the scene's value.

#include <array>
#include <utility>

#include "engine/scene/scene.hpp"

namespace quicksand {

template <typename Choice, std::size_t n>
using Words = std::array<std::pair<Choice, const char*>, n>;

constexpr Words<Dimension, 3> words_of(Dimension) {
  return {{{Dimension::plane_strain, "plane_strain"},
           {Dimension::axisymmetric, "axisymmetric"},
           {Dimension::space, "space"}}};
}
constexpr Words<SideKind, 4> words_of(SideKind) {
  return {{{SideKind::slip, "slip"},
           {SideKind::no_slip, "no_slip"},
           {SideKind::symmetry, "symmetry"},
           {SideKind::open, "open"}}};
}
constexpr Words<PermeabilityLaw, 4> words_of(PermeabilityLaw) {
  return {{{PermeabilityLaw::constant, "constant"},
           {PermeabilityLaw::kozeny_carman, "kozeny_carman"},
           {PermeabilityLaw::power, "power"},
           {PermeabilityLaw::ergun, "ergun"}}};
}
constexpr Words<SoilLaw, 3> words_of(SoilLaw) {
  return {{{SoilLaw::linear_elastic, "linear_elastic"},
           {SoilLaw::mohr_coulomb, "mohr_coulomb"},
           {SoilLaw::modified_cam_clay, "modified_cam_clay"}}};
}
constexpr Words<BodyKind, 3> words_of(BodyKind) {
  return {
      {{BodyKind::soil, "soil"}, {BodyKind::saturated_soil, "saturated_soil"}, {BodyKind::water, "water"}}};
}
constexpr Words<InitialPressure, 3> words_of(InitialPressure) {
  return {{{InitialPressure::hydrostatic, "hydrostatic"},
           {InitialPressure::zero, "zero"},
           {InitialPressure::uniform, "uniform"}}};
}
constexpr Words<InitialStress, 3> words_of(InitialStress) {
  return {{{InitialStress::zero, "zero"}, {InitialStress::k0, "k0"}, {InitialStress::uniform, "uniform"}}};
}
constexpr Words<Load::Kind, 2> words_of(Load::Kind) {
  return {{{Load::Kind::traction, "traction"}, {Load::Kind::plate, "plate"}}};
}
constexpr Words<BodySide, 6> words_of(BodySide) {
  return {{{BodySide::left, "left"},
           {BodySide::right, "right"},
           {BodySide::bottom, "bottom"},
           {BodySide::top, "top"},
           {BodySide::front, "front"},
           {BodySide::back, "back"}}};
}
constexpr Words<Preset, 3> words_of(Preset) {
  return {{{Preset::draft, "draft"}, {Preset::standard, "standard"}, {Preset::fine, "fine"}}};
}
constexpr Words<Kernel, 2> words_of(Kernel) {
  return {{{Kernel::quadratic, "quadratic"}, {Kernel::linear, "linear"}}};
}
constexpr Words<Transfer, 2> words_of(Transfer) {
  return {{{Transfer::flip, "flip"}, {Transfer::apic, "apic"}}};
}
constexpr Words<PressureScheme, 2> words_of(PressureScheme) {
  return {{{PressureScheme::implicit, "implicit"}, {PressureScheme::explicit_scheme, "explicit"}}};
}

template <typename Choice>
constexpr const char* word_of(Choice choice) {
  for (const auto& [value, word] : words_of(choice))
    if (value == choice) return word;
  return "";
}

/// Keys of domain.sides in the order of Domain::sides.
constexpr std::array<const char*, 6> side_words{"left", "right", "bottom", "top", "front", "back"};

}  // namespace quicksand

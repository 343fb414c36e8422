#pragma once
// The parts of `check`, each about one thing. Every part adds faults and assumes nothing about the others.

#include <string>
#include <vector>

#include "engine/scene/scene.hpp"
#include "engine/scene/stages.hpp"
#include "engine/scene/text.hpp"

namespace quicksand {

using Faults = std::vector<Fault>;

/// Names given twice.
void check_names(const Scene& scene, Faults& faults);
/// Soils, gravity and initial state: values that contradict each other, or that nothing uses.
void check_materials(const Scene& scene, Faults& faults);
/// Loads and stages: times, names they refer to, gates and loads without effect.
void check_stages(const Scene& scene, Faults& faults);
/// Intervals, fields, quantities of probes, and watches.
void check_output(const Scene& scene, Faults& faults);
/// The grid. False: it cannot be laid out, and nothing can be compared with it.
bool check_grid(const Scene& scene, Faults& faults);
/// Walls, gates, reservoirs, sections, plates and probes against the grid and each other. Needs a sound grid.
void check_lines(const Scene& scene, Faults& faults);
void check_reservoirs(const Scene& scene, Faults& faults);
void check_sections(const Scene& scene, Faults& faults);
void check_plates(const Scene& scene, Faults& faults);
void check_probe_places(const Scene& scene, Faults& faults);
/// Regions of bodies against the domain, the blocks and each other. Needs a sound grid.
void check_bodies(const Scene& scene, Faults& faults);
/// Young's modulus and the water's bulk modulus against the weight that they bear.
void check_softness(const Scene& scene, Faults& faults);

/// Number of cells along an axis of a sound grid; 1 along the third axis of the plane.
long cells_along(const Scene& scene, std::size_t axis);
bool is_box(const std::optional<Region>& block);
/// False, and a fault, if the box is empty.
bool check_box(const Scene& scene, const Region& box, const std::string& pointer, Faults& faults);

// Words of faults.
/// "there is no gate "door": there are "valve" and "sluice""
std::string there_is_no(const std::string& what, const std::string& name,
                        const std::vector<std::string>& names);
template <typename Items>
std::string there_is_no(const std::string& what, const std::string& name, const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return there_is_no(what, name, names);
}
inline std::string at_index(const char* list, std::size_t index, const std::string& rest = {}) {
  return std::string("/") + list + "/" + std::to_string(index) + rest;
}
std::string escaped(const std::string& name);  ///< a name as one step of a JSON pointer
std::string at_soil(const std::string& name, const std::string& rest = {});

}  // namespace quicksand

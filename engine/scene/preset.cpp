#include "engine/scene/preset.hpp"

namespace quicksand {

void apply_preset(Preset preset, Numerics& numerics) {
  struct Choice {
    Preset preset;
    double cell_size_factor;    // –, cells twice or half as large: a quarter or four times the points
    int points_per_cell;        // per axis; fewer lose track of porosity, more cost time
    double pressure_tolerance;  // –, relative; looser saves iterations at the price of volume drift
  };
  constexpr Choice choices[] = {
      {Preset::draft, 2, 2, 1e-5}, {Preset::standard, 1, 2, 1e-6}, {Preset::fine, 0.5, 2, 1e-7}};
  numerics.preset = preset;
  for (const Choice& choice : choices)
    if (choice.preset == preset) {
      numerics.cell_size_factor = choice.cell_size_factor;
      numerics.points_per_cell = choice.points_per_cell;
      numerics.pressure_tolerance = choice.pressure_tolerance;
    }
}

}  // namespace quicksand

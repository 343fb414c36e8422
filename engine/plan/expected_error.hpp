#pragma once
// How wrong an answer is expected to be before it is computed, from what the verification cases showed.

#include "engine/scene/scene.hpp"

namespace quicksand {

/// What a scene may do decides how fast its error falls with the cells.
enum class ErrorClass {
  smooth,      ///< soil that does not yield, pore water, water at rest: consolidation, seepage, waves
  yielding,    ///< soil whose law yields: failure, loosening, excavation
  free_water,  ///< water alone, or set free by gates and open sides
};
const char* word_of(ErrorClass kind);

ErrorClass error_class(const Scene& scene);

/// –, of a figure's range or of its reference: no closed form of the verification cases was missed by more on
/// such cells (tests/verification/book.cpp holds every page to it; cases/presets.md). It counts the factor
/// on domain.cell_size, as whoever chose the standard cells knew the problem; where the largest body has
/// fewer than ten of the cells, the fewest that are verified, it grows in proportion.
double expected_error(const Scene& scene);

}  // namespace quicksand

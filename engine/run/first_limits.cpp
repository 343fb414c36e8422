#include "engine/run/first_limits.hpp"

#include <algorithm>
#include <limits>

#include "engine/step/step.hpp"

namespace quicksand {

template <int D>
void limits_before_first_step(const State<D>& s, StepReport<D>& report) {
  double limit = std::numeric_limits<double>::infinity(), fast_wave = limit;
  for (std::size_t p = 0; p < s.soil.size(); ++p) {
    const int k = s.soil.soil[p];
    const StepLimit& l = s.constants.step_limits[k];
    const double n = s.soil.porosity[p];
    const double modulus = s.constants.soils[k].template constrained_modulus<D>(soil_state(s.soil, p), n);
    const bool confined = s.cell[s.grid.index(s.grid.cell_of(s.soil.x[p]))].confined;
    limit = std::min(limit, confined ? l.saturated(n, modulus) : l.dry(n, modulus));
    if (s.constants.explicit_pressure) fast_wave = std::min(fast_wave, l.fast_wave(n, modulus));
  }
  report.soil_limit = limit;
  report.fast_wave_limit = fast_wave;
}

template void limits_before_first_step<2>(const State<2>&, StepReport<2>&);
template void limits_before_first_step<3>(const State<3>&, StepReport<3>&);

}  // namespace quicksand

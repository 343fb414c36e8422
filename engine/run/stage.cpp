#include "engine/run/stage.hpp"

#include <cmath>

#include "engine/run/setup.hpp"

namespace quicksand {
namespace {

template <int D>
void scale_inertia(double inertia, State<D>& s, StageChange<D>& change) {
  Constants<D>& c = s.constants;
  if (inertia == c.inertia) return;
  const double ratio = inertia / c.inertia;
  if (ratio > 1) {
    const auto slow_down = [&](auto& set) {
      for (Vec<D>& v : set.v)
        for (double& component : v) component /= ratio;
      for (auto& gradient : set.affine)
        for (Vec<D>& row : gradient)
          for (double& component : row) component /= ratio;
    };
    slow_down(s.soil), slow_down(s.water);
  } else {
    for (int d = 0; d < D; ++d) {
      change.impulse[d] += (ratio - 1) * s.momentum[d];
      s.momentum[d] *= ratio;
    }
  }
  c.inertia = inertia;
  // Waves take √inertia times as long: rates per transit stay.
  c.pic_rate /= std::sqrt(ratio);
  c.drift_time *= std::sqrt(ratio);
  scale_limits(s);
}

}  // namespace

template <int D>
StageChange<D> begin_stage(const Scene& scene, std::size_t index, State<D>& s) {
  StageChange<D> change;
  change.removed = remove_bodies(scene, scene.stages[index], s);
  enter_stage(scene, scene.stages[index], s);
  if (change.removed.anything) look_again(s);
  scale_inertia(slow_process(scene, index).inertia, s, change);
  return change;
}

void InertiaWatch::begin(const Scene& scene, std::size_t stage, double time) {
  active_ = scene.stages[stage].quasi_static;
  if (!active_) return;
  const SlowProcess slow = slow_process(scene, stage);
  settled_ = time + kSettlingPart * slow.process_time;
  reports_.push_back({scene.stages[stage].name, slow.inertia, slow.process_time,
                      slow.transit_time * std::sqrt(slow.inertia), 0, true});
}

template StageChange<2> begin_stage<2>(const Scene&, std::size_t, State<2>&);
template StageChange<3> begin_stage<3>(const Scene&, std::size_t, State<3>&);

}  // namespace quicksand

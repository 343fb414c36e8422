#pragma once
#include "engine/run/run.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// Names of all fields a frame can hold, in the order in which they are written.
const std::vector<std::string>& frame_fields();

/// All points (moving soil, fixed soil, water; each in seeding order) with the fields asked for in the scene.
template <int D>
Frame make_frame(const Scene& scene, const State<D>& state, std::size_t index, const std::string& stage);

}  // namespace quicksand

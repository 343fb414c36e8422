#pragma once
#include <string>
#include <string_view>

#include "engine/run/archive.hpp"
#include "engine/scene/scene.hpp"
#include "engine/step/state.hpp"

namespace quicksand {

/// What of a state lasts from one step to the next, between two steps of stage `stage`. Everything else is
/// made again from it, by the scene or by the next step, so that a state that was loaded goes on bit for bit
/// as the one that was saved, on any number of threads.
template <int D>
void save_state(Saver& to, State<D>& state);

/// `state` must come from make_state(scene). Throws std::runtime_error when the bytes are not those of such a
/// state.
template <int D>
void load_state(Loader& from, const Scene& scene, std::size_t stage, State<D>& state);

}  // namespace quicksand

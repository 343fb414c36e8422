#pragma once

namespace quicksand {

/// Fingerprint of the engine's sources, its compiler and the processor it was built for. Only the same one
/// goes on from a checkpoint: state may lie otherwise in another, and the bits differ.
const char* engine_build();

}  // namespace quicksand

#pragma once

namespace quicksand {

/// Part of an interval that counts as rounding of time.
inline constexpr double kTimeRounding = 1e-9;

}  // namespace quicksand

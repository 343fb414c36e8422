#pragma once
#include <set>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"

namespace quicksand {

/// Removes faults that may only be the consequence of another: those at, above or below a refused place, and
/// those that compare with a part of the case that could not be read ("unknown gate" when the gates are
/// wrong).
std::vector<Fault> without_consequences(std::vector<Fault> faults, const std::set<std::string>& refused);

}  // namespace quicksand

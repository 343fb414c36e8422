#pragma once
// What holds in every scene. Each check names what it found broken, with figures.

#include <string>
#include <vector>

#include "engine/scene/scene.hpp"
#include "tests/verification/recorder.hpp"

namespace quicksand::test {

using Broken = std::vector<std::string>;

/// A number as findings give it, three digits.
std::string figure(double value);

/// Finite values, masses, water volume, energy, walls, pressures. A failed run is held to the first ones
/// only, in the frames that it wrote.
Broken invariants(const Scene& scene, const RunReport& report, const Recorder& results);

/// Closed forms: "hydrostatic", "fall" or none.
void check_form(const Scene& scene, const std::string& form, const RunReport& report, const Recorder& results,
                Broken& broken);

/// The same bits.
void check_same(const Recorder& one, const Recorder& other, Broken& broken);

/// The same scene with lengths and times multiplied, densities not: the same numbers, to 1e-8.
void check_similar(const Scene& scene, const Recorder& base, const Recorder& other, double length,
                   double time, Broken& broken);

}  // namespace quicksand::test

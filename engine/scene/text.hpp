#pragma once
// Values of a scene in words.

#include <string>

#include "engine/scene/scene.hpp"

namespace quicksand {

std::size_t axes(const Scene& scene);  ///< 2 in the plane, 3 in space

std::string text(double value);                    ///< shortest text that reads back as the value to 9 digits
std::string text(double value, const char* form);  ///< as printf forms it, up to 47 characters
std::string text(const Scene& scene, const Vec3& point);  ///< "(x, y)" or "(x, y, z)"
std::string cell_words(const Scene& scene);               ///< "cells of 0.04 m (cell_size 0.02 × factor 2)"

}  // namespace quicksand

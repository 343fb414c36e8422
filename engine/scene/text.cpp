#include "engine/scene/text.hpp"

#include <charconv>
#include <cstdio>

namespace quicksand {

std::size_t axes(const Scene& scene) { return scene.domain.dimension == Dimension::space ? 3 : 2; }

std::string text(double value) {
  char buffer[32];
  const auto end =
      std::to_chars(buffer, buffer + sizeof buffer, value == 0 ? 0.0 : value, std::chars_format::general, 9);
  return std::string(buffer, end.ptr);
}

std::string text(double value, const char* form) {
  char words[48];
  std::snprintf(words, sizeof words, form, value);
  return words;
}

std::string text(const Scene& scene, const Vec3& point) {
  std::string words = "(" + text(point[0]) + ", " + text(point[1]);
  if (axes(scene) == 3) words += ", " + text(point[2]);
  return words + ")";
}

std::string cell_words(const Scene& scene) {
  const double factor = scene.numerics.cell_size_factor;
  std::string words = "cells of " + text(scene.cell_size()) + " m";
  if (factor != 1)
    words += " (cell_size " + text(scene.domain.cell_size) + " × cell_size_factor " + text(factor) + ")";
  return words;
}

}  // namespace quicksand

#pragma once
// What pictures are drawn with: a few shapes, as SVG or as PNG.

#include <memory>
#include <string>
#include <vector>

namespace quicksand {

struct Spot {
  double x = 0, y = 0;  ///< pixels from the left and the top
};
enum class Anchor { start, middle, end };

/// Colours are "#rrggbb".
class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void line(Spot from, Spot to, const std::string& colour) = 0;
  virtual void path(const std::vector<Spot>& corners, const std::string& colour) = 0;
  virtual void disc(Spot centre, double radius, const std::string& colour) = 0;
  /// `at` is on the words' base line; UTF-8.
  virtual void words(Spot at, const std::string& text, double size, Anchor anchor,
                     const std::string& colour) = 0;
  /// The file's bytes; nothing can be drawn afterwards.
  virtual std::string finish() = 0;
};

/// White, of that many pixels.
std::unique_ptr<Canvas> svg_canvas(int width, int height);
/// The same; throws std::runtime_error without memory for it. The fonts are the machine's.
std::unique_ptr<Canvas> png_canvas(int width, int height);

}  // namespace quicksand

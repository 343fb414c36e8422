#include <cairo.h>

#include <stdexcept>

#include "engine/study/canvas.hpp"

namespace quicksand {
namespace {

constexpr double kHalfPixel = 0.5;  // lines of one pixel are sharp between two

class PngCanvas final : public Canvas {
 public:
  PngCanvas(int width, int height)
      : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
        pen_(cairo_create(surface_)) {
    cairo_select_font_face(pen_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_line_width(pen_, 1);
    colour("#ffffff");
    cairo_paint(pen_);
  }
  ~PngCanvas() override {
    cairo_destroy(pen_);
    cairo_surface_destroy(surface_);
  }
  PngCanvas(const PngCanvas&) = delete;
  PngCanvas& operator=(const PngCanvas&) = delete;

  void line(Spot from, Spot to, const std::string& ink) override { path({from, to}, ink); }
  void path(const std::vector<Spot>& corners, const std::string& ink) override {
    colour(ink);
    cairo_new_path(pen_);  // words leave their end as a first corner
    for (const Spot& corner : corners) cairo_line_to(pen_, corner.x + kHalfPixel, corner.y + kHalfPixel);
    cairo_stroke(pen_);
  }
  void disc(Spot centre, double radius, const std::string& ink) override {
    colour(ink);
    cairo_new_path(pen_);
    cairo_arc(pen_, centre.x, centre.y, radius, 0, 6.2831853);
    cairo_fill(pen_);
  }
  void words(Spot at, const std::string& text, double size, Anchor anchor, const std::string& ink) override {
    colour(ink);
    cairo_set_font_size(pen_, size);
    cairo_text_extents_t extents;
    cairo_text_extents(pen_, text.c_str(), &extents);
    const double share = anchor == Anchor::start ? 0 : anchor == Anchor::end ? 1 : 0.5;
    cairo_move_to(pen_, at.x - share * extents.x_advance, at.y);
    cairo_show_text(pen_, text.c_str());
  }
  std::string finish() override {
    std::string bytes;
    const auto take = [](void* to, const unsigned char* data, unsigned length) {
      static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
      return CAIRO_STATUS_SUCCESS;
    };
    if (const auto status = cairo_surface_write_to_png_stream(surface_, take, &bytes);
        status != CAIRO_STATUS_SUCCESS)
      throw std::runtime_error(std::string("the picture cannot be made: ") + cairo_status_to_string(status));
    return bytes;
  }

 private:
  void colour(const std::string& hex) {
    const long rgb = std::stol(hex.substr(1), nullptr, 16);
    constexpr double full = 255;
    cairo_set_source_rgb(pen_, static_cast<double>(rgb >> 16 & 0xff) / full,
                         static_cast<double>(rgb >> 8 & 0xff) / full, static_cast<double>(rgb & 0xff) / full);
  }

  cairo_surface_t* surface_;
  cairo_t* pen_;
};

}  // namespace

std::unique_ptr<Canvas> png_canvas(int width, int height) {
  return std::make_unique<PngCanvas>(width, height);
}

}  // namespace quicksand

#include "engine/scene/text.hpp"
#include "engine/study/canvas.hpp"

namespace quicksand {
namespace {

std::string place(double value) { return text(value, "%.5g"); }

std::string escaped(const std::string& plain) {
  std::string text;
  for (const char c : plain)
    text += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return text;
}

class SvgCanvas final : public Canvas {
 public:
  SvgCanvas(int width, int height)
      : text_("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) + "\" height=\"" +
              std::to_string(height) + "\" font-family=\"sans-serif\">\n" +
              "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n") {}

  void line(Spot from, Spot to, const std::string& colour) override {
    text_ += "<line x1=\"" + place(from.x) + "\" y1=\"" + place(from.y) + "\" x2=\"" + place(to.x) +
             "\" y2=\"" + place(to.y) + "\" stroke=\"" + colour + "\"/>\n";
  }
  void path(const std::vector<Spot>& corners, const std::string& colour) override {
    text_ += "<polyline fill=\"none\" stroke=\"" + colour + "\" points=\"";
    for (const Spot& corner : corners) text_ += place(corner.x) + "," + place(corner.y) + " ";
    text_ += "\"/>\n";
  }
  void disc(Spot centre, double radius, const std::string& colour) override {
    text_ += "<circle cx=\"" + place(centre.x) + "\" cy=\"" + place(centre.y) + "\" r=\"" + place(radius) +
             "\" fill=\"" + colour + "\"/>\n";
  }
  void words(Spot at, const std::string& text, double size, Anchor anchor,
             const std::string& colour) override {
    const char* where = anchor == Anchor::start ? "start" : anchor == Anchor::end ? "end" : "middle";
    text_ += "<text x=\"" + place(at.x) + "\" y=\"" + place(at.y) + "\" font-size=\"" + place(size) +
             "\" text-anchor=\"" + where + "\" fill=\"" + colour + "\">" + escaped(text) + "</text>\n";
  }
  std::string finish() override { return text_ + "</svg>\n"; }

 private:
  std::string text_;
};

}  // namespace

std::unique_ptr<Canvas> svg_canvas(int width, int height) {
  return std::make_unique<SvgCanvas>(width, height);
}

}  // namespace quicksand

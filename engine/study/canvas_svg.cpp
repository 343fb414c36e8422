#include <cstdio>

#include "engine/study/canvas.hpp"

namespace quicksand {
namespace {

std::string number(double value) {
  char words[48];
  std::snprintf(words, sizeof words, "%.5g", value);
  return words;
}

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
    text_ += "<line x1=\"" + number(from.x) + "\" y1=\"" + number(from.y) + "\" x2=\"" + number(to.x) +
             "\" y2=\"" + number(to.y) + "\" stroke=\"" + colour + "\"/>\n";
  }
  void path(const std::vector<Spot>& corners, const std::string& colour) override {
    text_ += "<polyline fill=\"none\" stroke=\"" + colour + "\" points=\"";
    for (const Spot& corner : corners) text_ += number(corner.x) + "," + number(corner.y) + " ";
    text_ += "\"/>\n";
  }
  void disc(Spot centre, double radius, const std::string& colour) override {
    text_ += "<circle cx=\"" + number(centre.x) + "\" cy=\"" + number(centre.y) + "\" r=\"" + number(radius) +
             "\" fill=\"" + colour + "\"/>\n";
  }
  void words(Spot at, const std::string& text, double size, Anchor anchor,
             const std::string& colour) override {
    const char* where = anchor == Anchor::start ? "start" : anchor == Anchor::end ? "end" : "middle";
    text_ += "<text x=\"" + number(at.x) + "\" y=\"" + number(at.y) + "\" font-size=\"" + number(size) +
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

// SPDX-License-Identifier: MIT
#include "daemon/cli/view/book_picture.hpp"

#include <array>
#include <numbers>

#include <fmt/format.h>

#include "core/compare/comparison.hpp"
#include "core/compare/picture.hpp"
#include "core/geometry/angle.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/png.hpp"

namespace popcut::cli {
namespace book_picture_parts {
namespace {

constexpr int kSides = 8, kPixels = 440, kTile = 220, kGap = 6, kTop = 34, kLeft = 92;
constexpr double kFromAbove_rad = radians(20.0);

struct Row {
  const char* name;
  const std::vector<float>* triangles;
  likeness::Rgb colour;
};

std::string words(int x, int y, int size, const std::string& text) {
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" "
      "fill=\"#222\">{}</text>\n",
      x, y, size, text);
}

}  // namespace
}  // namespace book_picture_parts

Result<std::string> book_picture(const BookScene& scene, const std::string& title) {
  using namespace book_picture_parts;
  std::vector<Row> rows{{"the book", &scene.pages, likeness::kPaperColour},
                        {"without pages", &scene.structure, likeness::kPaperColour}};
  if (!scene.model.empty()) rows.push_back({"the model", &scene.model, likeness::kModelColour});
  const likeness::Box around = likeness::box_of(scene.pages);
  const int width = kLeft + kSides * (kTile + kGap) + kGap;
  const int height = kTop + static_cast<int>(rows.size()) * (kTile + kGap) + kGap;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\">\n",
      width, height);
  svg += words(kGap, 22, 15, xml_escaped(title));
  likeness::DepthImage image;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int top = kTop + static_cast<int>(r) * (kTile + kGap);
    // The last rows are closer to the eye, so that the shape can be judged.
    const likeness::Box box = r == 0 ? around : likeness::box_of(*rows[1].triangles);
    svg += words(kGap, top + kTile / 2, 12, rows[r].name);
    for (int k = 0; k < kSides; ++k) {
      const double turn_rad = 2.0 * std::numbers::pi * (k + 0.5) / kSides;
      const likeness::Frame frame{likeness::risen_view(turn_rad, kFromAbove_rad), box.centre(),
                                  box.diagonal(), kPixels};
      likeness::draw(frame, *rows[r].triangles, image);
      const auto pixels =
          likeness::shaded(image, frame.pitch_mm(),
                           static_cast<float>(likeness::kWithin * box.diagonal()), rows[r].colour);
      const auto png = png_of_pixels(pixels.rgb, pixels.size, pixels.size);
      if (!png) return png;
      svg += fmt::format(
          "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" "
          "href=\"data:image/png;base64,{}\"/>\n",
          kLeft + k * (kTile + kGap), top, kTile, kTile, daemon::base64(*png));
    }
  }
  return svg + "</svg>\n";
}

}  // namespace popcut::cli

// SPDX-License-Identifier: MIT
#include "daemon/cli/view/book_picture.hpp"

#include <numbers>
#include <utility>

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

constexpr int kSides = 8, kTile = 220, kGap = 6, kTop = 34, kLeft = 92;
constexpr double kFromAbove_rad = radians(20.0);

struct Row {
  std::string name;
  const std::vector<float>* triangles;
  likeness::Rgb colour;
  likeness::Box box;  ///< that is shown
};

std::string words(int x, int y, int size, const std::string& text) {
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" "
      "fill=\"#222\">{}</text>\n",
      x, y, size, text);
}

/// A picture of each row from each view, `tile` pixels wide.
Result<std::string> picture_of(const std::vector<Row>& rows,
                               const std::vector<likeness::View>& views, int tile,
                               const std::string& title) {
  const int width = kLeft + static_cast<int>(views.size()) * (tile + kGap) + kGap;
  const int height = kTop + static_cast<int>(rows.size()) * (tile + kGap) + kGap;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\">\n",
      width, height);
  svg += words(kGap, 22, 15, xml_escaped(title));
  likeness::DepthImage image;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int top = kTop + static_cast<int>(r) * (tile + kGap);
    const likeness::Box& box = rows[r].box;
    svg += words(kGap, top + tile / 2, 12, rows[r].name);
    for (std::size_t k = 0; k < views.size(); ++k) {
      const likeness::Frame frame{views[k], box.centre(), box.diagonal(), 2 * tile};
      likeness::draw(frame, *rows[r].triangles, image);
      const auto pixels =
          likeness::shaded(image, frame.pitch_mm(),
                           static_cast<float>(likeness::kWithin * box.diagonal()), rows[r].colour);
      const auto png = png_of_pixels(pixels.rgb, pixels.size, pixels.size);
      if (!png) return png;
      svg += fmt::format(
          "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" "
          "href=\"data:image/png;base64,{}\"/>\n",
          kLeft + static_cast<int>(k) * (tile + kGap), top, tile, tile, daemon::base64(*png));
    }
  }
  return svg + "</svg>\n";
}

}  // namespace
}  // namespace book_picture_parts

Result<std::string> book_picture(const BookScene& scene, const std::string& title) {
  using namespace book_picture_parts;
  // The last rows are closer to the eye, so that the shape can be judged.
  const likeness::Box around = likeness::box_of(scene.pages),
                      near = likeness::box_of(scene.structure);
  std::vector<Row> rows{{"the book", &scene.pages, likeness::kPaperColour, around},
                        {"without pages", &scene.structure, likeness::kPaperColour, near}};
  if (!scene.model.empty())
    rows.push_back({"the model", &scene.model, likeness::kModelColour, near});
  std::vector<likeness::View> views;
  for (int k = 0; k < kSides; ++k)
    views.push_back(
        likeness::risen_view(2.0 * std::numbers::pi * (k + 0.5) / kSides, kFromAbove_rad));
  return picture_of(rows, views, kTile, title);
}

Result<std::string> opened_picture(const std::vector<OpenedCard>& openings,
                                   const std::vector<float>& model, const std::string& title) {
  using namespace book_picture_parts;
  constexpr int kLargeTile = 330;
  const likeness::Box around = likeness::box_of(openings.front().triangles);
  std::vector<Row> rows;
  rows.reserve(openings.size() + 1);
  for (const OpenedCard& one : openings)
    rows.push_back({one.words, &one.triangles, likeness::kPaperColour, around});
  rows.push_back({"the model", &model, likeness::kModelColour, around});
  std::vector<likeness::View> views;
  for (const auto& [turn_deg, above_deg] :
       {std::pair(0.0, 20.0), std::pair(35.0, 30.0), std::pair(-35.0, 30.0), std::pair(0.0, 50.0)})
    views.push_back(likeness::risen_view(radians(turn_deg), radians(above_deg)));
  return picture_of(rows, views, kLargeTile, title);
}

}  // namespace popcut::cli

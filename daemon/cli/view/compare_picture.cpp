// SPDX-License-Identifier: MIT
#include "daemon/cli/view/compare_picture.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "core/compare/picture.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/png.hpp"

namespace popcut::cli {
namespace compare_picture_parts {
namespace {

using likeness::DepthImage;
using likeness::Pixels;
using likeness::Rgb;

constexpr int kPixels = 480, kTile = 300, kGap = 8, kTop = 58, kLegend = 34;

Result<std::string> tile(const Pixels& pixels, int column, int row) {
  auto png = png_of_pixels(pixels.rgb, pixels.size, pixels.size);
  if (!png) return png;
  return fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"data:image/png;base64,{}\"/>\n",
      kGap + column * (kTile + kGap), kTop + row * (kTile + kGap), kTile, kTile,
      daemon::base64(*png));
}

std::string words(double x, double y, int size, const std::string& text) {
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\" "
      "fill=\"#222\">{}</text>\n",
      x, y, size, text);
}

std::string legend(int top) {
  std::string out;
  int x = kGap;
  const auto add = [&](const Rgb& colour, const std::string& what, int width) {
    out += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"12\" fill=\"rgb({},{},{})\" "
        "stroke=\"#888\" stroke-width=\"0.5\"/>\n",
        x, top, colour[0], colour[1], colour[2]);
    out += words(x + 17, top + 11, 12, what);
    x += width;
  };
  add(likeness::kAgrees, "same depth", 120);
  add(likeness::kNearer, "card nearer by 10 % of the diagonal", 255);
  add(likeness::kFarther, "farther", 95);
  add(likeness::kMissing, "model without card", 160);
  add(likeness::kBeyond, "card without model", 150);
  return out;
}

}  // namespace
}  // namespace compare_picture_parts

Result<std::string> compare_picture(const likeness::Target& target, likeness::Triangles model,
                                    likeness::Triangles structure, const std::string& title) {
  using namespace compare_picture_parts;
  likeness::Scene scene = target.scene();
  scene.pixels = kPixels;
  const std::vector<likeness::View>& all = target.scene().views;
  // The diagonal, one from aside and one from above; of a round, a third apart.
  const std::array<std::size_t, 3> chosen =
      scene.corner ? std::array<std::size_t, 3>{0, 1, 3}
                   : std::array<std::size_t, 3>{0, all.size() / 3, 2 * all.size() / 3};
  scene.views.clear();
  for (const std::size_t k : chosen) scene.views.push_back(all[std::min(k, all.size() - 1)]);
  const likeness::Target seen(model, scene);
  const auto jump = static_cast<float>(likeness::kWithin * seen.box().diagonal());
  const int width = 3 * (kTile + kGap) + kGap;
  const int height = kTop + 3 * (kTile + kGap) + kLegend;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\">\n",
      width, height);
  svg += words(kGap, 22, 15, xml_escaped(title));
  constexpr std::array<const char*, 3> kHeads{"model", "card", "difference"};
  for (std::size_t k = 0; k < 3; ++k)
    svg += words(kGap + static_cast<double>(k) * (kTile + kGap), 48, 13, kHeads.at(k));
  DepthImage image;
  for (std::size_t k = 0; k < 3; ++k) {
    const likeness::Frame frame = seen.frame(k);
    const int row = static_cast<int>(k);
    likeness::draw(frame, model, image);
    auto first =
        tile(likeness::shaded(image, frame.pitch_mm(), jump, likeness::kModelColour), 0, row);
    if (!first) return first;
    likeness::draw(frame, structure, image);
    auto second =
        tile(likeness::shaded(image, frame.pitch_mm(), jump, likeness::kPaperColour), 1, row);
    if (!second) return second;
    seen.draw_view(k, structure, image);
    auto third = tile(likeness::difference(seen, k, image), 2, row);
    if (!third) return third;
    svg += *first + *second + *third;
  }
  svg += legend(height - kLegend + 8) + "</svg>\n";
  return png_of_svg(svg, 2 * std::max(width, height));
}

}  // namespace popcut::cli

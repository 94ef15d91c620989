// SPDX-License-Identifier: MIT
#include "daemon/cli/search/front_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/compare/picture.hpp"
#include "core/geometry/angle.hpp"
#include "core/search/standing.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/cli/view/compare_picture.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/png.hpp"
#include "daemon/planning/search/thumbnail.hpp"

namespace popcut::cli {
namespace front_picture_parts {
namespace {

using planning::FoundCard;
using planning::FoundCards;

constexpr int kPixels = 480, kGap = 12, kTop = 44, kWords = 58;

/// The page's tiles, in rows.
struct Tiles {
  int width{240}, height{240}, across{4};
};
/// For pictures of printed cards, which show two sides.
constexpr Tiles kWideTiles{400, 200, 3};
struct Place {
  int x{}, y{};
};
Place place_of(const Tiles& tiles, std::size_t tile) {
  const int k = static_cast<int>(tile);
  return {kGap + k % tiles.across * (tiles.width + kGap),
          kTop + k / tiles.across * (tiles.height + kWords + kGap)};
}

std::string words(double x, double y, int size, const std::string& text, bool bold = false) {
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\"{} "
      "fill=\"#222\">{}</text>\n",
      x, y, size, bold ? " font-weight=\"bold\"" : "", xml_escaped(text));
}

/// A picture (PNG) with three lines below it.
std::string tile(const Tiles& tiles, std::size_t at, const std::string& png,
                 const std::array<std::string, 3>& lines) {
  const Place place = place_of(tiles, at);
  std::string out = fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"data:image/png;base64,{}\"/>\n",
      place.x, place.y, tiles.width, tiles.height, daemon::base64(png));
  for (std::size_t k = 0; k < lines.size(); ++k)
    out += words(place.x + 2, place.y + tiles.height + 16 + 17 * static_cast<int>(k), 13, lines[k],
                 k == 0);
  return out;
}

Result<std::string> drawn_tile(const Tiles& tiles, std::size_t at, const likeness::Target& frame_of,
                               likeness::Triangles shown, const likeness::Rgb& colour,
                               const std::array<std::string, 3>& lines) {
  const likeness::Frame frame = frame_of.frame(0);
  likeness::DepthImage image;
  likeness::draw(frame, shown, image);
  const auto jump = static_cast<float>(likeness::kWithin * frame_of.box().diagonal());
  const likeness::Pixels pixels = likeness::shaded(image, frame.pitch_mm(), jump, colour);
  const auto png = png_of_pixels(pixels.rgb, pixels.size, pixels.size);
  if (!png) return png;
  return tile(tiles, at, *png, lines);
}

/// The errors over the times.
std::string graph(const Tiles& tiles, std::size_t at, const FoundCards& found) {
  const Place place = place_of(tiles, at);
  constexpr double kLeft = 40, kBottom = 30;
  double most_s = 0.0, most_error = 0.0;
  for (const FoundCard& card : found.front) {
    most_s = std::max(most_s, card.cost.hands.time_s);
    most_error = std::max(most_error, card.error());
  }
  const double width = tiles.width - kLeft - 12, height = tiles.height - kBottom - 24;
  const auto x = [&](double s) { return place.x + kLeft + width * s / (1.05 * most_s); };
  const auto y = [&](double error) {
    return place.y + 24 + height * (1.0 - error / (1.1 * most_error));
  };
  std::string out =
      fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\" fill=\"none\" stroke=\"#888\"/>\n",
                  x(0), place.y + 24.0, y(0), x(1.05 * most_s));
  std::string line;
  for (const FoundCard& card : found.front) {
    const double px = x(card.cost.hands.time_s), py = y(card.error());
    line += line.empty() ? fmt::format("M{:.1f} {:.1f}", px, py)
                         : fmt::format("H{:.1f}V{:.1f}", px, py);
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#2166ac\"/>\n", px, py);
    out += words(px + 5, py - 5, 11, fmt::format("{}", &card - found.front.data() + 1));
  }
  out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#2166ac\"/>\n", line);
  out += words(place.x + 2, place.y + 14, 12, fmt::format("error (0 to {:.2f})", 1.1 * most_error));
  out += words(place.x + kLeft, y(0) + 18, 12,
               fmt::format("minutes of folding (0 to {:.1f})", 1.05 * most_s / 60.0));
  return out;
}

std::string settings(const Candidate& c) {
  if (c.style == DesignStyle::Facets)
    return fmt::format("facets, strips {:g} mm, planes {:g} mm", c.strip_mm, c.pitch_mm);
  if (c.style == DesignStyle::Silhouette)
    return fmt::format("silhouette, {} layer{}", c.layers, c.layers == 1 ? "" : "s");
  return fmt::format("{} lattice, {} x {} units", style_name(c), c.slices, c.units);
}

/// The first lines of a page of tiles.
std::string page_head(const Tiles& tiles, int count, const std::string& title) {
  const int rows = (count + tiles.across - 1) / tiles.across;
  const int width = kGap + tiles.across * (tiles.width + kGap);
  const int height = kTop + rows * (tiles.height + kWords + kGap);
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
             "viewBox=\"0 0 {0} {1}\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
             width, height) +
         words(kGap, 26, 17, title, true);
}

/// The axis of the file that points along `axis` of the card (0: out of the wall, 2: up).
std::string axis_along(const FoundCard& card, std::size_t axis) {
  std::string best;
  float most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float> points(9, 0.0F);
    points[3 + k] = 1;
    const std::vector<float> placed = likeness::placed(points, card.placement);
    const float along = placed[3 + axis] - placed[axis];
    if (std::abs(along) <= most) continue;
    most = std::abs(along);
    best = std::string(along < 0 ? "-" : "") + "xyz"[k];
  }
  return best;
}

}  // namespace
}  // namespace front_picture_parts

Stand stand_of(const planning::FoundCard& card) {
  return {front_picture_parts::axis_along(card, 2), front_picture_parts::axis_along(card, 0)};
}

Result<std::string> sides_picture(const TriangleMesh& mesh, const std::string& up,
                                  const Stand& taken) {
  using namespace front_picture_parts;
  const std::string upright = up == "any" ? taken.up : up;
  const auto other = [](const std::string& axis) { return axis == "y" ? "z" : "y"; };
  std::vector<Stand> stands;
  for (const std::string& front : up_words())
    if (front != "any" && front.back() != upright.back()) stands.push_back({upright, front});
  const std::string lying = other(upright);
  for (const char* front : {lying == "z" ? "-y" : "z", "x"}) stands.push_back({lying, front});
  const Tiles tiles;
  std::string svg = page_head(tiles, static_cast<int>(stands.size()),
                              "Which picture shows the model as it should stand and "
                              "look at you?");
  for (std::size_t k = 0; k < stands.size(); ++k) {
    const Stand& stand = stands[k];
    const auto turns = upright_turns(up_side(stand.up), up_side(stand.front));
    if (turns.empty()) continue;
    const std::vector<float> standing = standing_model(mesh, way_of(mesh, turns.front()));
    likeness::Scene scene;
    scene.pixels = kPixels;
    scene.views = {likeness::risen_view(0, radians(15))};
    const bool is_taken = stand.up == taken.up && stand.front == taken.front;
    auto part = drawn_tile(tiles, k, likeness::Target(standing, scene), standing,
                           is_taken ? likeness::kModelColour : likeness::kPaperColour,
                           {fmt::format("--up {} --front {}", stand.up, stand.front),
                            is_taken ? "the card to make shows this" : "", ""});
    if (!part) return part;
    svg += *part;
  }
  return svg + "</svg>\n";
}

std::string front_folder(const planning::FoundCard& card, std::size_t k) {
  return fmt::format("{}-{:02}", card.made.book ? "book" : "card", k + 1);
}

Result<std::string> card_picture(const planning::FoundCards& found, const planning::FoundCard& card,
                                 const std::string& title) {
  const std::vector<float> around = planning::model_around(found.mesh, card);
  const likeness::Target aim(around, planning::pictured_scene(card, 64));
  return compare_picture(aim, around, card.structure, title);
}

Result<std::string> front_picture(const planning::FoundCards& found, const std::string& title,
                                  const std::optional<ColourMesh>& model) {
  using namespace front_picture_parts;
  const FoundCard& best = found.front.back();
  const bool is_printed = model && !best.made.book;
  const Tiles tiles = is_printed ? kWideTiles : Tiles{};
  const std::size_t count = found.front.size() + 2;
  std::string svg = page_head(tiles, static_cast<int>(count), title);
  const std::array<std::string, 3> model_words{
      "the model",
      fmt::format("{} can show {:.0f} % of it",
                  best.made.book ? fmt::format("{} cards", best.made.parts.size())
                                 : std::string("one card"),
                  100 * found.seen_share),
      best.made.book ? "turned as in the best book" : "turned as in the best card"};
  Result<std::string> part;
  if (is_printed) {
    part = planning::model_png(best, *model).map([&](const std::string& png) {
      return tile(tiles, 0, png, model_words);
    });
  } else {
    const std::vector<float> around_best = planning::model_around(found.mesh, best);
    part =
        drawn_tile(tiles, 0, likeness::Target(around_best, planning::pictured_scene(best, kPixels)),
                   around_best, likeness::kModelColour, model_words);
  }
  if (!part) return part;
  svg += *part;
  for (std::size_t k = 0; k < found.front.size(); ++k) {
    const FoundCard& card = found.front[k];
    const std::array<std::string, 3> lines{
        fmt::format(
            "{}: {}{} folds, {:.0f} min{}", k + 1, k == found.recommended ? "make this; " : "",
            card.cost.hands.folds, std::max(1.0, card.cost.hands.time_s / 60.0),
            k == found.recommended ? std::string() : fmt::format(" ({})", card.cost.hands.label)),
        settings(card.candidate),
        fmt::format("error {:.3f}; {:.1f} min to cut", card.error(), card.cost.seconds / 60.0)};
    if (is_printed) {
      const auto png = planning::thumbnail_png(found.mesh, card, model);
      if (!png) return png;
      svg += tile(tiles, k + 1, *png, lines);
      continue;
    }
    part = drawn_tile(tiles, k + 1,
                      likeness::Target(planning::model_around(found.mesh, card),
                                       planning::pictured_scene(card, kPixels)),
                      card.structure, likeness::kPaperColour, lines);
    if (!part) return part;
    svg += *part;
  }
  return svg + graph(tiles, count - 1, found) + "</svg>\n";
}

}  // namespace popcut::cli

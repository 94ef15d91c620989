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

constexpr int kPixels = 480, kTile = 240, kGap = 12, kTop = 44, kWords = 58, kAcross = 4;

/// Places of the page's tiles, in rows.
struct Place {
  int x{}, y{};
};
Place place_of(std::size_t tile) {
  const int k = static_cast<int>(tile);
  return {kGap + k % kAcross * (kTile + kGap), kTop + k / kAcross * (kTile + kWords + kGap)};
}

std::string words(double x, double y, int size, const std::string& text, bool bold = false) {
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"{}\"{} "
      "fill=\"#222\">{}</text>\n",
      x, y, size, bold ? " font-weight=\"bold\"" : "", xml_escaped(text));
}

Result<std::string> tile(std::size_t at, const likeness::Target& frame_of,
                         likeness::Triangles shown, const likeness::Rgb& colour,
                         const std::array<std::string, 3>& lines) {
  const likeness::Frame frame = frame_of.frame(0);
  likeness::DepthImage image;
  likeness::draw(frame, shown, image);
  const auto jump = static_cast<float>(likeness::kWithin * frame_of.box().diagonal());
  const likeness::Pixels pixels = likeness::shaded(image, frame.pitch_mm(), jump, colour);
  const auto png = png_of_pixels(pixels.rgb, pixels.size, pixels.size);
  if (!png) return png;
  const Place place = place_of(at);
  std::string out = fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"data:image/png;base64,{}\"/>\n",
      place.x, place.y, kTile, kTile, daemon::base64(*png));
  for (std::size_t k = 0; k < lines.size(); ++k)
    out +=
        words(place.x + 2, place.y + kTile + 16 + 17 * static_cast<int>(k), 13, lines[k], k == 0);
  return out;
}

/// The errors over the times.
std::string graph(std::size_t at, const FoundCards& found) {
  const Place place = place_of(at);
  constexpr double kLeft = 40, kBottom = 30;
  double most_s = 0.0, most_error = 0.0;
  for (const FoundCard& card : found.front) {
    most_s = std::max(most_s, card.cost.hands.time_s);
    most_error = std::max(most_error, card.figures.error());
  }
  const double width = kTile - kLeft - 12, height = kTile - kBottom - 24;
  const auto x = [&](double s) { return place.x + kLeft + width * s / (1.05 * most_s); };
  const auto y = [&](double error) {
    return place.y + 24 + height * (1.0 - error / (1.1 * most_error));
  };
  std::string out =
      fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\" fill=\"none\" stroke=\"#888\"/>\n",
                  x(0), place.y + 24.0, y(0), x(1.05 * most_s));
  std::string line;
  for (const FoundCard& card : found.front) {
    const double px = x(card.cost.hands.time_s), py = y(card.figures.error());
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
  if (c.style == DesignStyle::Silhouette) return fmt::format("silhouette, {} layers", c.layers);
  return fmt::format("{} lattice, {} x {} units", style_name(c), c.slices, c.units);
}

/// The first lines of a page of tiles.
std::string page_head(std::size_t tiles, const std::string& title) {
  const std::size_t rows = (tiles + kAcross - 1) / kAcross;
  const int width = kGap + kAcross * (kTile + kGap);
  const int height = kTop + static_cast<int>(rows) * (kTile + kWords + kGap);
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
  std::string svg = page_head(stands.size(),
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
    auto part = tile(k, likeness::Target(standing, scene), standing,
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
  const std::vector<float> around = planning::model_around(found, card);
  const likeness::Target aim(around, planning::pictured_scene(card, 64));
  return compare_picture(aim, around, card.structure, title);
}

Result<std::string> front_picture(const planning::FoundCards& found, const std::string& title) {
  using namespace front_picture_parts;
  const std::size_t tiles = found.front.size() + 2;
  std::string svg = page_head(tiles, title);
  const FoundCard& best = found.front.back();
  const auto add = [&](const Result<std::string>& part) {
    if (part) svg += *part;
    return part.has_value();
  };
  const std::vector<float> around_best = planning::model_around(found, best);
  auto part = tile(0, likeness::Target(around_best, planning::pictured_scene(best, kPixels)),
                   around_best, likeness::kModelColour,
                   {"the model",
                    fmt::format("{} can show {:.0f} % of it",
                                best.made.book ? fmt::format("{} cards", best.made.parts.size())
                                               : std::string("one card"),
                                100 * found.seen_share),
                    best.made.book ? "turned as in the best book" : "turned as in the best card"});
  if (!add(part)) return part;
  for (std::size_t k = 0; k < found.front.size(); ++k) {
    const FoundCard& card = found.front[k];
    part = tile(
        k + 1,
        likeness::Target(planning::model_around(found, card),
                         planning::pictured_scene(card, kPixels)),
        card.structure, likeness::kPaperColour,
        {fmt::format(
             "{}: {}{} folds, {:.0f} min{}", k + 1, k == found.recommended ? "make this; " : "",
             card.cost.hands.folds, std::max(1.0, card.cost.hands.time_s / 60.0),
             k == found.recommended ? std::string() : fmt::format(" ({})", card.cost.hands.label)),
         settings(card.candidate),
         fmt::format("error {:.3f}; {:.1f} min to cut", card.figures.error(),
                     card.cost.seconds / 60.0)});
    if (!add(part)) return part;
  }
  svg += graph(tiles - 1, found) + "</svg>\n";
  return svg;
}

}  // namespace popcut::cli

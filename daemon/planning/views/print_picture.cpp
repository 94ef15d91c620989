// SPDX-License-Identifier: MIT
#include "daemon/planning/views/print_picture.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <vector>

#include "core/artwork/boxes_artwork.hpp"
#include "core/artwork/layers_artwork.hpp"
#include "core/artwork/lit_picture.hpp"
#include "core/artwork/standing_print.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/design_angle.hpp"
#include "daemon/pictures/png.hpp"

namespace popcut::planning {
namespace print_picture_parts {
namespace {

constexpr Colour kBack{247, 245, 240, 255};

/// Where the two pictures of a design are seen from.
struct Eyes {
  PictureLook front, aside;

  Eyes(const PrintedDesign& design, std::size_t tile_px) {
    const double psi_rad = design.parts.front().design_psi_rad;
    front.width_px = front.height_px = tile_px;
    aside = front;
    if (design.around) {
      const auto toward = [&](double turn_rad) {
        return Vec3{std::cos(turn_rad), std::tan(radians(24)), std::sin(turn_rad)};
      };
      front.up = aside.up = {0, 1, 0};
      front.toward = toward(0.5 * psi_rad);
      aside.toward = toward(0.5 * psi_rad + std::numbers::pi);
    } else {
      const DesignAngle opening = DesignAngle::of_rad(psi_rad);
      front.toward = {1 + opening.cosine, 0, opening.sine};
      const double azimuth = radians(36);
      aside.toward = {std::cos(azimuth), std::sin(azimuth), std::tan(radians(28))};
    }
  }
};

PartsStand parts_stand(const PrintedDesign& design) {
  return design.around ? PartsStand::Around : PartsStand::InRow;
}

ColourImage picture_of_models(const PrintedDesign& design, const std::vector<const Pattern*>& parts,
                              PictureLook look) {
  look.shade = design.coloured ? 0.4 : 0.65;
  return lit_picture(standing_models(parts, parts_stand(design), design.models), look);
}

/// Tiles side by side, three bytes a pixel.
class Strip {
 public:
  Strip(std::size_t tiles, std::size_t tile_px)
      : side_(tile_px), width_(tiles * tile_px), rgb_(3 * width_ * tile_px, 255) {}

  void add(const ColourImage& tile) {
    for (std::size_t j = 0; j < side_; ++j)
      for (std::size_t i = 0; i < side_; ++i)
        std::memcpy(&rgb_[3 * (j * width_ + at_ + i)], tile.at(i, j), 3);
    at_ += side_;
  }
  [[nodiscard]] Result<std::string> png() const {
    return png_of_pixels(rgb_, static_cast<int>(width_), static_cast<int>(side_));
  }

 private:
  std::size_t side_, width_, at_{};
  std::vector<std::uint8_t> rgb_;
};

/// A model from the front, which looks along x, and its card open flat: from there and from both
/// sides; without the model, from there and from one side.
Result<std::string> open_picture(const ColourMesh& model, const ColourMesh& card, bool with_model,
                                 int tile_px) {
  const auto side = static_cast<std::size_t>(tile_px);
  PictureLook look;
  look.width_px = look.height_px = side;
  const auto toward = [](double turn_deg) {
    return Vec3{std::cos(radians(turn_deg)), std::sin(radians(turn_deg)), std::tan(radians(30))};
  };
  look.toward = toward(0);
  Strip strip(with_model ? 4 : 2, side);
  if (with_model) strip.add(lit_picture(model, look));
  look.back = kBack;
  for (const double turn_deg : {0.0, -35.0, 35.0}) {
    if (turn_deg > 0.0 && !with_model) break;
    look.toward = toward(turn_deg);
    strip.add(lit_picture(card, look));
  }
  return strip.png();
}

}  // namespace
}  // namespace print_picture_parts

Result<std::string> print_picture(const PrintedDesign& design, const Artwork& artwork,
                                  bool with_model, int tile_px) {
  using namespace print_picture_parts;
  std::vector<const Pattern*> parts;
  for (const Pattern& part : design.parts) parts.push_back(&part);
  const auto card = standing_print(parts, parts_stand(design), artwork);
  if (!card) return tl::unexpected(card.error());
  const auto side = static_cast<std::size_t>(tile_px);
  Eyes eyes(design, side);
  const bool is_modelled = with_model && !design.models.empty();
  Strip strip(is_modelled ? 3 : 2, side);
  if (is_modelled) strip.add(picture_of_models(design, parts, eyes.front));
  for (PictureLook* look : {&eyes.front, &eyes.aside}) {
    look->back = kBack;
    strip.add(lit_picture(*card, *look));
  }
  return strip.png();
}

Result<std::string> model_picture(const PrintedDesign& design, int tile_px) {
  using namespace print_picture_parts;
  std::vector<const Pattern*> parts;
  for (const Pattern& part : design.parts) parts.push_back(&part);
  const auto side = static_cast<std::size_t>(tile_px);
  Strip strip(1, side);
  strip.add(picture_of_models(design, parts, Eyes(design, side).front));
  return strip.png();
}

Result<std::string> print_picture(const PrintedLayers& layers, std::span<const DrawnPart> places,
                                  const Artwork& artwork, bool with_model, int tile_px) {
  return print_picture_parts::open_picture(as_seen_in_front(layers.card, layers.model),
                                           standing_layers(layers.card, places, artwork),
                                           with_model, tile_px);
}

Result<std::string> print_picture(const PrintedBoxes& boxes, std::span<const DrawnPart> places,
                                  const Artwork& artwork, bool with_model, int tile_px) {
  return print_picture_parts::open_picture(
      as_seen_in_front(boxes.card, boxes.model),
      as_seen_in_front(boxes.card, standing_boxes(boxes.card, places, artwork)), with_model,
      tile_px);
}

}  // namespace popcut::planning

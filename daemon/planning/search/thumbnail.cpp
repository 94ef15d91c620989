// SPDX-License-Identifier: MIT
#include "daemon/planning/search/thumbnail.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/artwork/boxes_artwork.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/artwork/layers_artwork.hpp"
#include "core/compare/picture.hpp"
#include "core/design/spec/spec.hpp"
#include "core/geometry/angle.hpp"
#include "daemon/pictures/png.hpp"
#include "daemon/planning/views/print_picture.hpp"
#include "daemon/planning/views/printed_design.hpp"

namespace popcut::planning {

likeness::Scene pictured_scene(const FoundCard& card, int pixels) {
  likeness::Scene scene;
  scene.pixels = pixels;
  if (card.made.book) {
    // Over a corner, so that a box shows three of its sides.
    for (const int turn : {40, 160, 280})
      scene.views.push_back(likeness::risen_view(radians(turn), radians(25)));
    return scene;
  }
  scene.views = likeness::cone_views();
  scene.corner = likeness::Corner{};
  return scene;
}

namespace thumbnail_parts {
namespace {

Result<PrintedDesign> printed_card(const FoundCard& card, const ColourMesh& model) {
  const auto spec = parse_design_spec(card.spec);
  if (!spec) return tl::unexpected(spec.error());
  return printed_design(*spec, {}, card.made, model);
}

/// With what is printed on it.
Result<std::string> printed_png(const FoundCard& card, const ColourMesh& model) {
  constexpr double kPixel_mm = 0.25;  // about two for one of the picture
  const auto design = printed_card(card, model);
  if (!design) return tl::unexpected(design.error());
  std::vector<const Pattern*> parts;
  for (const Pattern& part : design->parts) parts.push_back(&part);
  ArtworkOptions how;
  how.pixel_mm = kPixel_mm;
  how.shade = usual_shade(*design);
  const auto artwork = design_artwork(parts, design->models, nullptr, how);
  if (!artwork) return tl::unexpected(artwork.error());
  return print_picture(*design, *artwork, false, kThumbnailHeight_px);
}

}  // namespace
}  // namespace thumbnail_parts

Result<std::string> model_png(const FoundCard& card, const ColourMesh& model) {
  const auto design = thumbnail_parts::printed_card(card, model);
  if (!design) return tl::unexpected(design.error());
  return model_picture(*design, kThumbnailHeight_px);
}

Result<std::string> thumbnail_png(const FoundGlued& card, const std::optional<ColourMesh>& model) {
  constexpr double kPixel_mm = 0.25;
  const PrintedDesign design = card.layers ? printed_layers(card.layers->made, model)
                                           : printed_boxes(card.boxes->made, model);
  ArtworkOptions how;
  how.pixel_mm = kPixel_mm;
  how.shade = usual_shade(design);
  const auto artwork =
      design.layers ? layers_artwork(design.layers->card, design.layers->model, card.places, how)
                    : boxes_artwork(design.boxes->card, design.boxes->model, card.places, how);
  if (!artwork) return tl::unexpected(artwork.error());
  return design.layers
             ? print_picture(*design.layers, card.places, *artwork, false, kThumbnailHeight_px)
             : print_picture(*design.boxes, card.places, *artwork, false, kThumbnailHeight_px);
}

Result<std::string> thumbnail_png(const TriangleMesh& mesh, const FoundCard& card,
                                  const std::optional<ColourMesh>& model) {
  if (model && !card.made.book)
    if (auto printed = thumbnail_parts::printed_png(card, *model)) return printed;
  constexpr int kSide = kThumbnailHeight_px, kBytes = 3;
  static_assert(kThumbnailWidth_px == 2 * kSide);
  likeness::Scene scene = pictured_scene(card, kSide);
  scene.views.resize(1);
  const std::vector<float> around = model_around(mesh, card);
  const likeness::Target target(around, scene);
  const likeness::Frame frame = target.frame(0);
  const auto jump_mm = static_cast<float>(likeness::kWithin * target.box().diagonal());
  likeness::DepthImage image;
  const auto shown = [&](likeness::Triangles what, const likeness::Rgb& colour) {
    likeness::draw(frame, what, image);
    return likeness::shaded(image, frame.pitch_mm(), jump_mm, colour);
  };
  const likeness::Pixels shape = shown(around, likeness::kModelColour);
  const likeness::Pixels made = shown(card.structure, likeness::kPaperColour);
  if (shape.size != kSide || made.size != kSide)
    return fail(ErrorKind::Internal, "thumbnail", "its two halves have other sizes");
  std::vector<std::uint8_t> rgb;
  rgb.reserve(static_cast<std::size_t>(kBytes * kThumbnailWidth_px * kThumbnailHeight_px));
  for (int row = 0; row < kSide; ++row)
    for (const likeness::Pixels* half : {&shape, &made}) {
      const auto begin = half->rgb.begin() + std::ptrdiff_t{kBytes} * row * kSide;
      rgb.insert(rgb.end(), begin, begin + std::ptrdiff_t{kBytes} * kSide);
    }
  return png_of_pixels(rgb, kThumbnailWidth_px, kThumbnailHeight_px);
}

}  // namespace popcut::planning

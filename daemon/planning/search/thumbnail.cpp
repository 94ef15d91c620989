// SPDX-License-Identifier: MIT
#include "daemon/planning/search/thumbnail.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/compare/picture.hpp"
#include "core/geometry/angle.hpp"
#include "daemon/pictures/png.hpp"

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

Result<std::string> thumbnail_png(const FoundCards& found, const FoundCard& card) {
  constexpr int kSide = kThumbnailHeight_px, kBytes = 3;
  static_assert(kThumbnailWidth_px == 2 * kSide);
  likeness::Scene scene = pictured_scene(card, kSide);
  scene.views.resize(1);
  const std::vector<float> around = model_around(found, card);
  const likeness::Target target(around, scene);
  const likeness::Frame frame = target.frame(0);
  const auto jump_mm = static_cast<float>(likeness::kWithin * target.box().diagonal());
  likeness::DepthImage image;
  const auto shown = [&](likeness::Triangles what, const likeness::Rgb& colour) {
    likeness::draw(frame, what, image);
    return likeness::shaded(image, frame.pitch_mm(), jump_mm, colour);
  };
  const likeness::Pixels model = shown(around, likeness::kModelColour);
  const likeness::Pixels made = shown(card.structure, likeness::kPaperColour);
  if (model.size != kSide || made.size != kSide)
    return fail(ErrorKind::Internal, "thumbnail", "its two halves have other sizes");
  std::vector<std::uint8_t> rgb;
  rgb.reserve(static_cast<std::size_t>(kBytes * kThumbnailWidth_px * kThumbnailHeight_px));
  for (int row = 0; row < kSide; ++row)
    for (const likeness::Pixels* half : {&model, &made}) {
      const auto begin = half->rgb.begin() + std::ptrdiff_t{kBytes} * row * kSide;
      rgb.insert(rgb.end(), begin, begin + std::ptrdiff_t{kBytes} * kSide);
    }
  return png_of_pixels(rgb, kThumbnailWidth_px, kThumbnailHeight_px);
}

}  // namespace popcut::planning

// SPDX-License-Identifier: MIT
#include "daemon/planning/search/thumbnail.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/compare/picture.hpp"
#include "daemon/pictures/png.hpp"

namespace popcut::planning {
namespace {

/// A view from above, turned about the spine, which stands upright.
likeness::View from_above(double turn_rad) {
  constexpr double kRise = 25 * std::numbers::pi / 180.0;
  likeness::View view;
  view.toward = Vec3(std::cos(kRise) * std::cos(turn_rad), std::sin(kRise),
                     std::cos(kRise) * std::sin(turn_rad));
  view.right = unit(cross(Vec3(0, 1, 0), view.toward));
  view.up = cross(view.toward, view.right);
  return view;
}

}  // namespace

likeness::Scene pictured_scene(const FoundCard& card, int pixels) {
  likeness::Scene scene;
  scene.pixels = pixels;
  if (card.made.book) {
    // Over a corner, so that a box shows three of its sides.
    constexpr double kFirst = 40 * std::numbers::pi / 180.0, kThird = std::numbers::pi * 2.0 / 3.0;
    for (const int k : {0, 1, 2}) scene.views.push_back(from_above(kFirst + k * kThird));
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

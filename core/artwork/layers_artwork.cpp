// SPDX-License-Identifier: MIT
#include "core/artwork/layers_artwork.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/artwork/parts_artwork.hpp"

namespace popcut {
namespace layers_artwork_parts {
namespace {

constexpr double kBeyond_mm = 1.5;  ///< so far ink goes on beyond the model

/// A stretch of depth behind the model's front.
struct SlabDepths {
  double from_mm{}, to_mm{};

  /// What of a ray is shown: the smaller the better.
  [[nodiscard]] std::array<double, 2> rank(double depth_mm) const {
    if (depth_mm < from_mm) return {1.0, from_mm - depth_mm};
    if (depth_mm >= to_mm) return {2.0, depth_mm};
    return {0.0, depth_mm};
  }
};

/// Where a place of the card lies in the picture along the look: x = across, y = down.
PagePoint seen_at(const LayeredCard& made, const Vec3& p) {
  const double along = made.looks_along_spine ? 1.0 : -1.0;
  return {p.x(), -p.z() - made.look.fall * along * (p.y() - made.begin_mm)};
}

/// The model as it is seen along the look with the depths of a slab first.
ColourImage slab_view(const LayeredCard& made, const ColourMesh& mesh, const SlabDepths& slab,
                      const PixelFrame& frame, double shade) {
  struct Seen {
    std::array<double, 2> rank{std::numeric_limits<double>::infinity(), 0.0};
    std::uint32_t triangle{};
    std::array<float, 2> weights{};
  };
  std::vector<Seen> seen(frame.pixels());
  const double along = made.looks_along_spine ? 1.0 : -1.0;
  const auto page = [&](const Vec3& p) { return seen_at(made, p); };
  for (std::uint32_t t = 0; t < mesh.size(); ++t) {
    std::array<PagePoint, 3> at;
    std::array<double, 3> across{};
    std::array<double, 3> depth{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = mesh.soup.corner(t, k);
      at[k] = page(p), across[k] = p.x(), depth[k] = along * (p.y() - made.begin_mm);
    }
    each_pixel(frame, at, [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
      const auto rank =
          slab.rank(w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2] -
                    made.look.behind_mm(w[0] * across[0] + w[1] * across[1] + w[2] * across[2]));
      Seen& before = seen[j * frame.width + i];
      if (!(rank < before.rank)) return;
      before = {rank, t, {static_cast<float>(w[0]), static_cast<float>(w[1])}};
    });
  }
  // Light falls on what a person in front sees, whose x is against the depth.
  const ColourMesh in_front = as_seen_in_front(made, ColourMesh{mesh.soup, {}, {}, {}, {}, {}});
  std::vector<float> lit(mesh.size(), -1.0F);
  ColourImage image(frame.width, frame.height);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (!std::isfinite(seen[k].rank[0])) continue;
    const std::uint32_t t = seen[k].triangle;
    if (lit[t] < 0.0F) lit[t] = static_cast<float>(brightness(in_front, t, {shade, {}}));
    const auto a = static_cast<double>(seen[k].weights[0]),
               b = static_cast<double>(seen[k].weights[1]);
    std::array<PagePoint, 3> at;
    for (std::size_t n = 0; n < 3; ++n) at[n] = page(mesh.soup.corner(t, n));
    const double pixels = 0.5 *
                          std::abs((at[1].x - at[0].x) * (at[2].y - at[0].y) -
                                   (at[1].y - at[0].y) * (at[2].x - at[0].x)) /
                          (frame.pixel_mm * frame.pixel_mm);
    Colour colour = colour_of(mesh, t, {a, b, 1.0 - a - b}, texels_across(mesh, t, pixels));
    colour.r *= lit[t], colour.g *= lit[t], colour.b *= lit[t];
    image.set(k % frame.width, k / frame.width, colour);
  }
  grow(image, static_cast<std::size_t>(std::llround(kBeyond_mm / frame.pixel_mm)));
  return image;
}

/// What is printed on a part, on the pixels of `frame`.
ColourImage drawn_on(const LayeredCard& made, std::size_t layer, const FaceSurface& surface,
                     const SheetPart& sheet, const ColourImage& view, const PixelFrame& view_frame,
                     const PixelFrame& frame) {
  ColourImage out(frame.width, frame.height);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (std::find(sheet.tabs.begin(), sheet.tabs.end(), surface.face[t]) != sheet.tabs.end())
      continue;
    const auto& c = surface.triangles[t];
    each_pixel(frame, {c[0].page, c[1].page, c[2].page},
               [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
                 Vec3 p = w[0] * c[0].place + w[1] * c[1].place + w[2] * c[2].place;
                 p.y() -= (made.looks_along_spine ? 1.0 : -1.0) * made.look.raised_share(layer) *
                          made.look.behind_mm(p.x());
                 const PagePoint at = view_frame.in_pixels(seen_at(made, p));
                 const double across = static_cast<double>(view_frame.width) - 1,
                              down = static_cast<double>(view_frame.height) - 1;
                 if (at.x < 0 || at.y < 0 || at.x > across || at.y > down) return;
                 const Colour colour = colour_between(view, at.x, at.y);
                 if (colour.a > 127) out.set(i, j, {colour.r, colour.g, colour.b, 255});
               });
  }
  return out;
}

}  // namespace
}  // namespace layers_artwork_parts

ColourMesh model_on_card(const LayeredCard& made, ColourMesh model) {
  model = placed_model(std::move(model), made.placement, made.origin);
  move_to_card(made, model.soup.corners);
  return model;
}

ColourMesh clay_on_card(const LayeredCard& made) { return clay_model(made.target); }

Result<Artwork> layers_artwork(const LayeredCard& made, const ColourMesh& model,
                               std::span<const DrawnPart> places, const ArtworkOptions& options) {
  using namespace layers_artwork_parts;
  Box seen;
  for (std::size_t k = 0; k + 2 < model.soup.corners.size(); k += 3)
    seen.add(seen_at(
        made, {model.soup.corners[k], model.soup.corners[k + 1], model.soup.corners[k + 2]}));
  // A model that is far off the card is seen nowhere; its picture is not larger than the card's.
  Box card;
  for (const CardLayer& layer : made.layers) {
    const double fall = made.look.fall * layer.depth_mm,
                 bend = std::abs(made.look.fall * made.look.behind_mm(layer.width_mm));
    card.add({-layer.width_mm, -layer.height_mm - fall - bend});
    card.add({layer.width_mm, bend - fall});
  }
  seen = {std::max(seen.x0, card.x0), std::max(seen.y0, card.y0), std::min(seen.x1, card.x1),
          std::min(seen.y1, card.y1)};
  if (!(seen.width() > 0.0 && seen.height() > 0.0))
    return fail(ErrorKind::Infeasible, "",
                "nothing of the model is seen on the card; give a model in the units and axes of "
                "the design's surface");
  const PixelFrame view_frame = frame_around(seen, 2.0 * kBeyond_mm, options.pixel_mm);
  return parts_artwork(made.card, open_pose(made), places, options,
                       [&](std::size_t p, const FaceSurface& surface,
                           const PixelFrame& frame) -> std::optional<ColourImage> {
                         if (p == 0 || p > made.layers.size()) return std::nullopt;
                         const std::size_t j = p - 1;
                         constexpr double kFar = std::numeric_limits<double>::infinity();
                         const auto between = [&](std::size_t k) {
                           return 0.5 * (made.layers[k - 1].depth_mm + made.layers[k].depth_mm);
                         };
                         const SlabDepths slab{j == 0 ? -kFar : between(j),
                                               j + 1 == made.layers.size() ? kFar : between(j + 1)};
                         return drawn_on(made, j, surface, made.card.parts[p],
                                         slab_view(made, model, slab, view_frame, options.shade),
                                         view_frame, frame);
                       });
}

ColourMesh as_seen_in_front(const LayeredCard& made, ColourMesh model) {
  const double along = made.looks_along_spine ? 1.0 : -1.0;
  std::vector<double>& corners = model.soup.corners;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
    std::swap(corners[k], corners[k + 1]), corners[k] *= -along, corners[k + 1] *= along;
  return model;
}

ColourMesh standing_layers(const LayeredCard& made, std::span<const DrawnPart> places,
                           const Artwork& artwork) {
  return as_seen_in_front(made, standing_parts(made.card, open_pose(made), places, artwork));
}

}  // namespace popcut

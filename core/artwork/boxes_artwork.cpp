// SPDX-License-Identifier: MIT
#include "core/artwork/boxes_artwork.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/artwork/artwork.hpp"
#include "core/artwork/parts_artwork.hpp"

namespace popcut {
namespace boxes_artwork_parts {
namespace {

/// The model as each face of a part is looked at, square to it: what is nearer than `near_mm`
/// first, its outermost point; else what is nearest. Nothing on `bare` faces.
ColourImage seen_on_faces(const ColourMesh& model, const SheetPart& sheet,
                          std::span<const std::uint32_t> bare,
                          std::span<const Eigen::Isometry3d> pose, const FaceSurface& surface,
                          const PixelFrame& frame, double near_mm, double shade) {
  struct Seen {
    std::array<double, 2> rank{std::numeric_limits<double>::infinity(), 0.0};
    std::uint32_t triangle{};
    std::array<double, 3> weights{};
    double pixels{};  ///< that the triangle covers
  };
  std::vector<Seen> seen(frame.pixels());
  const std::vector<std::uint32_t> face_at = face_pixels(surface, frame);
  for (std::uint32_t f = 0; f < sheet.faces.size(); ++f) {
    const auto own = std::find(surface.face.begin(), surface.face.end(), f);
    if (own == surface.face.end() || std::find(bare.begin(), bare.end(), f) != bare.end() ||
        std::find(sheet.tabs.begin(), sheet.tabs.end(), f) != sheet.tabs.end())
      continue;
    const Eigen::Isometry3d to_sheet = pose[f].inverse();
    const FaceSurface::Corner& corner =
        surface.triangles[static_cast<std::size_t>(own - surface.face.begin())][0];
    const Vec3 at_corner = to_sheet * corner.place;
    for (std::uint32_t t = 0; t < model.size(); ++t) {
      std::array<PagePoint, 3> at;
      std::array<double, 3> out{};  // of the face
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = to_sheet * model.soup.corner(t, k);
        at[k] = {corner.page.x + p.y() - at_corner.y(), corner.page.y + p.x() - at_corner.x()};
        out[k] = p.z();
      }
      const double pixels = 0.5 *
                            std::abs((at[1].x - at[0].x) * (at[2].y - at[0].y) -
                                     (at[1].y - at[0].y) * (at[2].x - at[0].x)) /
                            (frame.pixel_mm * frame.pixel_mm);
      each_pixel(frame, at, [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
        const std::size_t pixel = j * frame.width + i;
        if (face_at[pixel] != f) return;
        const double far = w[0] * out[0] + w[1] * out[1] + w[2] * out[2];
        const std::array<double, 2> rank =
            std::abs(far) <= near_mm ? std::array{0.0, -far} : std::array{1.0, std::abs(far)};
        if (rank < seen[pixel].rank) seen[pixel] = {rank, t, w, pixels};
      });
    }
  }
  ColourImage image(frame.width, frame.height);
  for (std::size_t pixel = 0; pixel < seen.size(); ++pixel) {
    const Seen& one = seen[pixel];
    if (!std::isfinite(one.rank[0])) continue;
    const double lit = brightness(model, one.triangle, {shade, {}});
    Colour colour =
        colour_of(model, one.triangle, one.weights, texels_across(model, one.triangle, one.pixels));
    colour.r *= static_cast<float>(lit), colour.g *= static_cast<float>(lit);
    colour.b *= static_cast<float>(lit);
    image.set(pixel % frame.width, pixel / frame.width, colour);
  }
  return image;
}

}  // namespace
}  // namespace boxes_artwork_parts

ColourMesh model_on_card(const BoxedCard& made, ColourMesh model) {
  model = placed_model(std::move(model), made.placement, made.origin);
  move_to_card(made, model.soup.corners);
  return model;
}

ColourMesh clay_on_card(const BoxedCard& made) { return clay_model(made.target); }

Result<Artwork> boxes_artwork(const BoxedCard& made, const ColourMesh& model,
                              std::span<const DrawnPart> places, const ArtworkOptions& options) {
  const PartPoses pose = open_pose(made);
  return parts_artwork(made.card, pose, places, options,
                       [&](std::size_t part, const FaceSurface& surface,
                           const PixelFrame& frame) -> std::optional<ColourImage> {
                         if (made.is_bare(part)) return std::nullopt;
                         const std::span<const std::uint32_t> pages(made.card.pages);
                         return boxes_artwork_parts::seen_on_faces(
                             model, made.card.parts[part], part == 0 ? pages : pages.first(0),
                             pose[part], surface, frame, made.near_mm(part), options.shade);
                       });
}

ColourMesh as_seen_in_front(const BoxedCard& made, ColourMesh model) {
  if (made.faces_along_spine()) {
    std::vector<double>& corners = model.soup.corners;
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
      std::swap(corners[k], corners[k + 1]), corners[k + 1] = -corners[k + 1];
  }
  return model;
}

ColourMesh standing_boxes(const BoxedCard& made, std::span<const DrawnPart> places,
                          const Artwork& artwork) {
  return standing_parts(made.card, open_pose(made), places, artwork);
}

}  // namespace popcut

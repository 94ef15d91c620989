// SPDX-License-Identifier: MIT
#include "core/artwork/standing_print.hpp"

#include <cmath>
#include <utility>

#include "core/artwork/face_pixels.hpp"

namespace popcut {
namespace standing_print_parts {
namespace {

/// Where a part stands among the others.
struct Place {
  double along_mm{}, cosine{1}, sine{0};

  Place(std::span<const Pattern* const> parts, std::size_t part, PartsStand stand) {
    if (stand == PartsStand::InRow) {
      along_mm = parts[part]->place.v_mm;
      return;
    }
    double turn_rad = 0;
    for (std::size_t k = 0; k < part; ++k) turn_rad += parts[k]->design_psi_rad;
    cosine = std::cos(turn_rad), sine = std::sin(turn_rad);
  }
  /// x turns toward z.
  [[nodiscard]] Vec3 of(const Vec3& p) const {
    return {cosine * p[0] - sine * p[2], p[1] + along_mm, sine * p[0] + cosine * p[2]};
  }
};

void append(ColourMesh& to, const ColourMesh& more) {
  const auto surfacings = static_cast<std::uint32_t>(to.surfacings.size());
  const auto textures = static_cast<std::int32_t>(to.textures.size());
  // Lists that one of them leaves empty: no place in a texture, and white.
  to.st.resize(3 * to.size());
  if (!more.tint.empty()) to.tint.resize(3 * to.size(), {1, 1, 1});
  to.soup.corners.insert(to.soup.corners.end(), more.soup.corners.begin(), more.soup.corners.end());
  to.st.insert(to.st.end(), more.st.begin(), more.st.end());
  to.st.resize(3 * to.size());
  to.tint.insert(to.tint.end(), more.tint.begin(), more.tint.end());
  if (!to.tint.empty()) to.tint.resize(3 * to.size(), {1, 1, 1});
  for (const std::uint32_t k : more.surfacing_of) to.surfacing_of.push_back(k + surfacings);
  for (Surfacing how : more.surfacings) {
    if (how.texture >= 0) how.texture += textures;
    to.surfacings.push_back(how);
  }
  to.textures.insert(to.textures.end(), more.textures.begin(), more.textures.end());
  to.coloured = to.coloured || more.coloured;
}

}  // namespace
}  // namespace standing_print_parts

Result<ColourMesh> standing_print(std::span<const Pattern* const> parts, PartsStand stand,
                                  const Artwork& artwork) {
  const PixelFrame& frame = artwork.frame;
  ColourMesh out;
  out.surfacings.push_back({{255, 255, 255, 255}, 0});
  out.textures.emplace_back(on_paper(artwork.image));
  out.textures.back().wraps.fill(PictureWrap::Clamp);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto surface = face_surface(*parts[k]);
    if (!surface) return tl::unexpected(surface.error());
    const standing_print_parts::Place place(parts, k, stand);
    const PatternPlace& page = parts[k]->place;
    for (const auto& triangle : surface->triangles) {
      for (const FaceSurface::Corner& corner : triangle) {
        const Vec3 p = place.of(corner.place);
        out.soup.corners.insert(out.soup.corners.end(), p.data(), p.data() + 3);
        const PagePoint at =
            frame.in_pixels({corner.page.x + page.v_mm, corner.page.y + page.u_mm});
        out.st.push_back({static_cast<float>((at.x + 0.5) / static_cast<double>(frame.width)),
                          static_cast<float>((at.y + 0.5) / static_cast<double>(frame.height))});
      }
      out.surfacing_of.push_back(0);
    }
  }
  out.coloured = true;
  return out;
}

ColourMesh standing_models(std::span<const Pattern* const> parts, PartsStand stand,
                           std::span<const ColourMesh> models) {
  ColourMesh out;
  for (std::size_t k = 0; k < models.size(); ++k) {
    ColourMesh model = models[k];
    const standing_print_parts::Place place(parts, k, stand);
    const DesignAngle opening = DesignAngle::of_rad(parts[k]->design_psi_rad);
    auto& corners = model.soup.corners;
    for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
      opening.to_space(corners[c], corners[c + 2]);
      const Vec3 p = place.of({corners[c], corners[c + 1], corners[c + 2]});
      corners[c] = p[0], corners[c + 1] = p[1], corners[c + 2] = p[2];
    }
    standing_print_parts::append(out, model);
  }
  return out;
}

}  // namespace popcut

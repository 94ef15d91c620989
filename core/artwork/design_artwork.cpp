// SPDX-License-Identifier: MIT
#include "core/artwork/design_artwork.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "core/design/shape_fit.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/picture/target_on_sheet.hpp"

namespace popcut {
namespace {

Box page_box(const Pattern& pattern) {
  Box box;
  for (const PatternVertex& p : pattern.vertices)
    box.add({p.v + pattern.place.v_mm, pattern.u(p) + pattern.place.u_mm});
  return box;
}

bool has_ink(const Artwork& artwork) {
  for (std::size_t pixel = 0; pixel < artwork.on_paper.size(); ++pixel)
    if (artwork.on_paper[pixel] != 0 && artwork.image.rgba[4 * pixel + 3] != 0) return true;
  return false;
}

/// A part's artwork on the page of all.
class PartArtwork {
 public:
  PartArtwork(const Pattern& pattern, const PixelFrame& frame, const ArtworkOptions& options)
      : pattern_(pattern),
        options_(options),
        opening_(DesignAngle::of_rad(pattern.design_psi_rad)),
        frame_(frame) {
    // The part's own page begins at its place.
    frame_.left_mm -= pattern.place.v_mm, frame_.top_mm -= pattern.place.u_mm;
  }

  [[nodiscard]] ColourImage drawn(const FaceSurface& surface, const ColourMesh* model,
                                  const Texture* image, const Box& whole) const {
    switch (options_.mode) {
      case PrintMode::View:
        return laid_on_kites(
            view_of_model(*model, pattern_.wall_mm, frame_, {options_.shade, opening_}));
      case PrintMode::Surface: {
        ColourMesh in_space = *model;
        for (std::size_t k = 0; k + 2 < in_space.soup.corners.size(); k += 3)
          opening_.to_space(in_space.soup.corners[k], in_space.soup.corners[k + 2]);
        const std::vector<std::uint8_t> bare =
            options_.bare_card ? faces_of_card(pattern_) : std::vector<std::uint8_t>{};
        return nearest_colours(in_space, surface, frame_, {options_.shade, {}}, bare,
                               options_.progress);
      }
      case PrintMode::Flat: {
        const double v = pattern_.place.v_mm, u = pattern_.place.u_mm;
        return laid_flat(*image, {whole.x0 - v, whole.y0 - u, whole.x1 - v, whole.y1 - u}, frame_);
      }
      case PrintMode::Lines:
        break;
    }
    return {frame_.width, frame_.height};
  }

  [[nodiscard]] const PixelFrame& frame() const { return frame_; }

 private:
  /// A picture on the flat sheet of stairs, laid so that it is exact on kites too: a place of the
  /// sheet shows what is seen through the place in space where it stands, along (1, 0, 1).
  [[nodiscard]] ColourImage laid_on_kites(ColourImage seen) const {
    if (pattern_.kites.empty()) return seen;
    ColourImage out = seen;
    for (const Kite& kite : pattern_.kites) {
      const KiteSection& section = kite.section;
      const double from = section.q.x - section.q.z;
      for (std::size_t j = 0; j < frame_.height; ++j) {
        const double along = frame_.middle(0, j).y - pattern_.wall_mm - from;  // from Q
        if (along <= 0.0 || along >= section.p_mm() + section.q_mm()) continue;
        const double down = std::min(along, section.q_mm());
        const KitePoint at = section.posed(section.q.x + (along - down), section.q.z - down,
                                           pattern_.design_psi_rad);
        double x = at.x, z = at.z;
        opening_.to_oblique(x, z);
        const double row = std::round(frame_.in_pixels({0.0, pattern_.wall_mm + x - z}).y);
        if (!(row >= 0.0 && row < static_cast<double>(frame_.height))) continue;
        for (std::size_t i = 0; i < frame_.width; ++i) {
          const double v = frame_.middle(i, j).x;
          if (v < kite.v0_mm || v > kite.v1_mm) continue;
          std::memcpy(out.at(i, j), seen.at(i, static_cast<std::size_t>(row)), 4);
        }
      }
    }
    return out;
  }

  const Pattern& pattern_;
  const ArtworkOptions& options_;
  DesignAngle opening_;
  PixelFrame frame_;
};

}  // namespace

ColourMesh model_on_sheet(ColourMesh model, const TargetPlacement& placement,
                          const Design& design) {
  const PlacementMap map(placement);
  std::vector<double> s_mm;
  for (const SliceReport& slice : design.report.slices) s_mm.push_back(slice.s_mm);
  const SpineMap along(design.strips, s_mm);
  auto& corners = model.soup.corners;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    const auto p = map.to_corner({corners[k], corners[k + 1], corners[k + 2]});
    corners[k] = p[0], corners[k + 1] = along.place_on_sheet(p[1]), corners[k + 2] = p[2];
  }
  return model;
}

ColourMesh clay_on_sheet(const Design& design) {
  ColourMesh mesh;
  mesh.soup = target_on_sheet(design, true);
  const DesignAngle opening = DesignAngle::of_rad(design.pattern.design_psi_rad);
  for (std::size_t k = 0; k + 2 < mesh.soup.corners.size(); k += 3)
    opening.to_oblique(mesh.soup.corners[k], mesh.soup.corners[k + 2]);
  make_clay(mesh);
  return mesh;
}

double artwork_margin_mm(const ArtworkOptions& options) {
  return std::max(options.trapping.bleed_mm, options.trapping.trap_mm) + 2 * options.pixel_mm;
}

Result<PixelFrame> artwork_frame(const Box& page, const ArtworkOptions& options) {
  const PixelFrame frame = frame_around(page, artwork_margin_mm(options), options.pixel_mm);
  if (frame.pixels() > kMaxPixels)
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("the artwork would have {} x {} pixels; at most {} million are "
                            "printed: use fewer dots an inch",
                            frame.width, frame.height, kMaxPixels / 1'000'000));
  return frame;
}

Result<Artwork> design_artwork(std::span<const Pattern* const> parts,
                               std::span<const ColourMesh> models, const Texture* image,
                               const ArtworkOptions& options) {
  Box whole;
  for (const Pattern* part : parts) {
    const Box box = page_box(*part);
    whole.add({box.x0, box.y0}), whole.add({box.x1, box.y1});
  }
  Artwork out;
  const auto frame = artwork_frame(whole, options);
  if (!frame) return tl::unexpected(frame.error());
  out.frame = *frame;
  out.image = ColourImage(out.frame.width, out.frame.height);
  out.on_paper.assign(out.frame.pixels(), 0);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto surface = face_surface(*parts[k]);
    if (!surface) return tl::unexpected(surface.error());
    const PartArtwork part(*parts[k], out.frame, options);
    tell(options.progress, "drawing the artwork");
    ColourImage drawn = part.drawn(*surface, models.empty() ? nullptr : &models[k], image, whole);
    const auto face = face_pixels(*surface, part.frame());
    const bool is_surface = options.mode == PrintMode::Surface;
    if (options.mode == PrintMode::View) grow(drawn, 2);
    // Where ink ends at a fold, a sheet that lies a little off shows it as a cut does.
    const bool at_folds = !is_surface || options.bare_card;
    const auto borders = at_folds ? fold_lines_on_page(*parts[k]) : std::vector<CutLine>{};
    trap(drawn, face, cut_lines(*parts[k]), borders, part.frame(), options.trapping, is_surface);
    for (std::size_t pixel = 0; pixel < face.size(); ++pixel) {
      // A part's own paper comes before what another one lets flow around itself.
      if (face[pixel] == kNoFace && (out.on_paper[pixel] != 0 || drawn.rgba[4 * pixel + 3] == 0))
        continue;
      std::memcpy(&out.image.rgba[4 * pixel], &drawn.rgba[4 * pixel], 4);
      if (face[pixel] != kNoFace) out.on_paper[pixel] = 1;
    }
  }
  if (options.mode == PrintMode::View && !has_ink(out))
    return fail(ErrorKind::Infeasible, "",
                "nothing of the model is seen on the card; give a model in the units and axes of "
                "the design's surface");
  return out;
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include "core/artwork/parts_artwork.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "core/design/target/placement_map.hpp"
#include "core/geometry/triangulate.hpp"

namespace popcut {
namespace parts_artwork_parts {
namespace {

/// The faces of a part: on the page of all, and in space. x is across the pages, y along the spine.
FaceSurface surface_of(const Structure& card, std::size_t part, const PartPoses& pose,
                       const DrawnPart& place) {
  const SheetPart& sheet = card.parts[part];
  Eigen::AlignedBox2d box;
  for (const Vec2& p : sheet.vertices) box.extend(p);
  const Vec2 by{place.box.x0 - box.min().y(), place.box.y0 - box.min().x()};
  FaceSurface out;
  for (std::uint32_t f = 0; f < sheet.faces.size(); ++f) {
    std::vector<Triangle> cut;
    if (!triangulate(sheet.vertices, sheet.faces[f], cut)) continue;
    for (const Triangle& t : cut) {
      auto& corners = out.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 p = sheet.vertices[t[k]];
        corners[k] = {{p.y() + by.x(), p.x() + by.y()}, pose[part][f] * Vec3{p.x(), p.y(), 0.0}};
      }
      out.face.push_back(f);
    }
  }
  return out;
}

/// Cuts of a part, or its folds, on the page of all.
std::vector<CutLine> lines_of(const Structure& card, std::size_t part, const PartPoses& pose,
                              const DrawnPart& place, bool folds) {
  const SheetPart& sheet = card.parts[part];
  Eigen::AlignedBox2d box;
  for (const Vec2& p : sheet.vertices) box.extend(p);
  const auto at = [&](std::uint32_t v) {
    const Vec2 p = sheet.vertices[v];
    return PagePoint{p.y() + place.box.x0 - box.min().y(), p.x() + place.box.y0 - box.min().x()};
  };
  std::vector<CutLine> out;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> inner;
  for (const PartFold& fold : folds_of(sheet, pose[part])) {
    inner.emplace_back(std::minmax(fold.from, fold.to));
    const bool is_cut = sheet.is_slit(fold.from, fold.to);
    if (is_cut != folds && (is_cut || std::abs(fold.angle_rad) > 1e-9))
      out.push_back({at(fold.from), at(fold.to)});
  }
  if (folds) return out;
  std::sort(inner.begin(), inner.end());
  for (const auto& face : sheet.faces)
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
      if (!std::binary_search(inner.begin(), inner.end(),
                              std::pair<std::uint32_t, std::uint32_t>(std::minmax(a, b))))
        out.push_back({at(a), at(b)});
    }
  return out;
}

}  // namespace
}  // namespace parts_artwork_parts

ColourMesh placed_model(ColourMesh model, const TargetPlacement& placement, const Vec3& origin) {
  const PlacementMap map(placement);
  std::vector<double>& corners = model.soup.corners;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    const auto p = map.to_corner({corners[k], corners[k + 1], corners[k + 2]});
    for (std::size_t n = 0; n < 3; ++n)
      corners[k + n] = p[n] - origin[static_cast<Eigen::Index>(n)];
  }
  return model;
}

ColourMesh clay_model(const TriangleSoup& target) {
  ColourMesh mesh;
  mesh.soup = target;
  make_clay(mesh);
  return mesh;
}

Result<Artwork> parts_artwork(const Structure& card, const PartPoses& pose,
                              std::span<const DrawnPart> places, const ArtworkOptions& options,
                              const DrawPart& draw) {
  using namespace parts_artwork_parts;
  if (options.mode == PrintMode::Flat || options.mode == PrintMode::Lines)
    return fail(ErrorKind::OutOfRange, "",
                "a card of several parts is printed with its model; use the mode view");
  Box whole;
  for (const DrawnPart& place : places)
    whole.add({place.box.x0, place.box.y0}), whole.add({place.box.x1, place.box.y1});
  Artwork out;
  const auto all = artwork_frame(whole, options);
  if (!all) return tl::unexpected(all.error());
  out.frame = *all;
  out.image = ColourImage(out.frame.width, out.frame.height);
  out.on_paper.assign(out.frame.pixels(), 0);
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    tell(options.progress, "drawing the artwork");
    // The part alone, with what flows around it.
    const double room = artwork_margin_mm(options);
    const auto first = out.frame.in_pixels({places[p].box.x0 - room, places[p].box.y0 - room}),
               last = out.frame.in_pixels({places[p].box.x1 + room, places[p].box.y1 + room});
    const auto index = [](double at, std::size_t most) {
      return static_cast<std::size_t>(std::clamp(std::round(at), 0.0, static_cast<double>(most)));
    };
    const std::size_t i0 = index(first.x, out.frame.width - 1),
                      j0 = index(first.y, out.frame.height - 1);
    const PixelFrame frame{out.frame.left_mm + static_cast<double>(i0) * options.pixel_mm,
                           out.frame.top_mm + static_cast<double>(j0) * options.pixel_mm,
                           options.pixel_mm, index(last.x, out.frame.width - 1) - i0 + 1,
                           index(last.y, out.frame.height - 1) - j0 + 1};
    const FaceSurface surface = surface_of(card, p, pose, places[p]);
    const std::vector<std::uint32_t> face = face_pixels(surface, frame);
    std::optional<ColourImage> drawn = draw(p, surface, frame);
    if (drawn)
      trap(*drawn, face, lines_of(card, p, pose, places[p], false),
           lines_of(card, p, pose, places[p], true), frame, options.trapping, false);
    for (std::size_t y = 0; y < frame.height; ++y)
      for (std::size_t x = 0; x < frame.width; ++x) {
        const std::size_t at = y * frame.width + x, pixel = (y + j0) * out.frame.width + x + i0;
        if (face[at] != kNoFace) out.on_paper[pixel] = 1;
        if (drawn && drawn->rgba[4 * at + 3] != 0)
          std::memcpy(&out.image.rgba[4 * pixel], &drawn->rgba[4 * at], 4);
      }
  }
  return out;
}

ColourMesh standing_parts(const Structure& card, const PartPoses& pose,
                          std::span<const DrawnPart> places, const Artwork& artwork) {
  using namespace parts_artwork_parts;
  const PixelFrame& frame = artwork.frame;
  ColourMesh out;
  out.surfacings.push_back({{255, 255, 255, 255}, 0});
  out.textures.emplace_back(on_paper(artwork.image));
  out.textures.back().wraps.fill(PictureWrap::Clamp);
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    const std::vector<std::uint32_t>& tabs = card.parts[p].tabs;
    const FaceSurface surface = surface_of(card, p, pose, places[p]);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      // Tabs lie in the planes that they are glued to, and are not seen.
      if (std::find(tabs.begin(), tabs.end(), surface.face[t]) != tabs.end()) continue;
      for (const FaceSurface::Corner& corner : surface.triangles[t]) {
        out.soup.corners.insert(out.soup.corners.end(), corner.place.data(),
                                corner.place.data() + 3);
        out.st.push_back(
            {static_cast<float>((corner.page.x - frame.left_mm) /
                                (static_cast<double>(frame.width) * frame.pixel_mm)),
             static_cast<float>((corner.page.y - frame.top_mm) /
                                (static_cast<double>(frame.height) * frame.pixel_mm))});
      }
      out.surfacing_of.push_back(0);
    }
  }
  return out;
}

}  // namespace popcut

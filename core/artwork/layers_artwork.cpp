// SPDX-License-Identifier: MIT
#include "core/artwork/layers_artwork.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/design/target/placement_map.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/triangulate.hpp"

namespace popcut {
namespace layers_artwork_parts {
namespace {

constexpr double kBeyond_mm = 1.5;  ///< so far ink goes on beyond the model

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

/// The model as it is seen from the front with the depths of a slab first: x = across, y = -z.
ColourImage slab_view(const LayeredCard& made, const ColourMesh& mesh, const SlabDepths& slab,
                      const PixelFrame& frame, double shade) {
  struct Seen {
    std::array<double, 2> rank{std::numeric_limits<double>::infinity(), 0.0};
    std::uint32_t triangle{};
    std::array<float, 2> weights{};
  };
  std::vector<Seen> seen(frame.pixels());
  const double along = made.looks_along_spine ? 1.0 : -1.0;
  const auto page = [](const Vec3& p) { return PagePoint{p.x(), -p.z()}; };
  for (std::uint32_t t = 0; t < mesh.size(); ++t) {
    std::array<PagePoint, 3> at;
    std::array<double, 3> depth{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = mesh.soup.corner(t, k);
      at[k] = page(p), depth[k] = along * (p.y() - made.begin_mm);
    }
    each_pixel(frame, at, [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
      const auto rank = slab.rank(w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2]);
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
    const double a = static_cast<double>(seen[k].weights[0]),
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
ColourImage drawn_on(const FaceSurface& surface, const SheetPart& sheet, const ColourImage& view,
                     const PixelFrame& view_frame, const PixelFrame& frame) {
  ColourImage out(frame.width, frame.height);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (std::find(sheet.tabs.begin(), sheet.tabs.end(), surface.face[t]) != sheet.tabs.end())
      continue;
    const auto& c = surface.triangles[t];
    each_pixel(frame, {c[0].page, c[1].page, c[2].page},
               [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
                 const Vec3 p = w[0] * c[0].place + w[1] * c[1].place + w[2] * c[2].place;
                 const PagePoint at = view_frame.in_pixels({p.x(), -p.z()});
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
  const PlacementMap map(made.placement);
  std::vector<double>& corners = model.soup.corners;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    const auto p = map.to_corner({corners[k], corners[k + 1], corners[k + 2]});
    for (std::size_t n = 0; n < 3; ++n)
      corners[k + n] = p[n] - made.origin[static_cast<Eigen::Index>(n)];
  }
  move_to_card(made, corners);
  return model;
}

ColourMesh clay_on_card(const LayeredCard& made) {
  ColourMesh mesh;
  mesh.soup = made.target;
  make_clay(mesh);
  return mesh;
}

Result<Artwork> layers_artwork(const LayeredCard& made, const ColourMesh& model,
                               std::span<const DrawnPart> places, const ArtworkOptions& options) {
  using namespace layers_artwork_parts;
  if (options.mode == PrintMode::Flat || options.mode == PrintMode::Lines)
    return fail(ErrorKind::OutOfRange, "",
                "a card of layers is printed with the model as it is seen from the front; use the "
                "mode view");
  Box whole, seen;
  for (const DrawnPart& place : places)
    whole.add({place.box.x0, place.box.y0}), whole.add({place.box.x1, place.box.y1});
  for (std::size_t k = 0; k + 2 < model.soup.corners.size(); k += 3)
    seen.add({model.soup.corners[k], -model.soup.corners[k + 2]});
  Artwork out;
  const auto frame = artwork_frame(whole, options);
  if (!frame) return tl::unexpected(frame.error());
  out.frame = *frame;
  // A model that is far off the card is seen nowhere; its picture is not larger than the card's.
  Box card;
  for (const CardLayer& layer : made.layers)
    card.add({-layer.width_mm, -layer.height_mm}), card.add({layer.width_mm, 0.0});
  seen = {std::max(seen.x0, card.x0), std::max(seen.y0, card.y0), std::min(seen.x1, card.x1),
          std::min(seen.y1, card.y1)};
  if (!(seen.width() > 0.0 && seen.height() > 0.0))
    return fail(ErrorKind::Infeasible, "",
                "nothing of the model is seen on the card; give a model in the units and axes of "
                "the design's surface");
  out.image = ColourImage(out.frame.width, out.frame.height);
  out.on_paper.assign(out.frame.pixels(), 0);
  const PixelFrame view_frame = frame_around(seen, 2.0 * kBeyond_mm, options.pixel_mm);
  const PartPoses pose = open_pose(made);
  for (std::size_t p = 0; p < made.card.parts.size(); ++p) {
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
    const FaceSurface surface = surface_of(made.card, p, pose, places[p]);
    const std::vector<std::uint32_t> face = face_pixels(surface, frame);
    ColourImage drawn(frame.width, frame.height);
    if (p > 0 && p <= made.layers.size()) {
      const std::size_t j = p - 1;
      constexpr double kFar = std::numeric_limits<double>::infinity();
      const auto between = [&](std::size_t k) {
        return 0.5 * (made.layers[k - 1].depth_mm + made.layers[k].depth_mm);
      };
      const SlabDepths slab{j == 0 ? -kFar : between(j),
                            j + 1 == made.layers.size() ? kFar : between(j + 1)};
      drawn = drawn_on(surface, made.card.parts[p],
                       slab_view(made, model, slab, view_frame, options.shade), view_frame, frame);
      trap(drawn, face, lines_of(made.card, p, pose, places[p], false),
           lines_of(made.card, p, pose, places[p], true), frame, options.trapping, false);
    }
    for (std::size_t y = 0; y < frame.height; ++y)
      for (std::size_t x = 0; x < frame.width; ++x) {
        const std::size_t at = y * frame.width + x, pixel = (y + j0) * out.frame.width + x + i0;
        if (face[at] != kNoFace) out.on_paper[pixel] = 1;
        if (drawn.rgba[4 * at + 3] != 0)
          std::memcpy(&out.image.rgba[4 * pixel], &drawn.rgba[4 * at], 4);
      }
  }
  return out;
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
  using namespace layers_artwork_parts;
  const PixelFrame& frame = artwork.frame;
  ColourMesh out;
  out.surfacings.push_back({{255, 255, 255, 255}, 0});
  out.textures.emplace_back(on_paper(artwork.image));
  out.textures.back().wraps.fill(PictureWrap::Clamp);
  const PartPoses pose = open_pose(made);
  for (std::size_t p = 0; p < made.card.parts.size(); ++p)
    for (const auto& triangle : surface_of(made.card, p, pose, places[p]).triangles) {
      for (const FaceSurface::Corner& corner : triangle) {
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
  return as_seen_in_front(made, std::move(out));
}

}  // namespace popcut

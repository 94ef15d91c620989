// SPDX-License-Identifier: MIT
#include "core/artwork/artwork.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/artwork/pixel_frame.hpp"
#include "core/fit/triangle_tree.hpp"

namespace popcut {
namespace {

/// The weights of a triangle's corners at a point in its plane.
std::array<double, 3> weights_at(const TriangleSoup& soup, std::size_t triangle, const Vec3& p) {
  const Vec3 a = soup.corner(triangle, 0);
  const Vec3 ab = soup.corner(triangle, 1) - a, ac = soup.corner(triangle, 2) - a, ap = p - a;
  const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
  const double b = dot(ap, ab), c = dot(ap, ac), all = bb * cc - bc * bc;
  if (!(all > 0)) return {1, 0, 0};
  const double v = std::clamp((cc * b - bc * c) / all, 0.0, 1.0);
  const double w = std::clamp((bb * c - bc * b) / all, 0.0, 1.0);
  return {1 - v - w, v, w};
}

/// A pixel near a cut.
struct NearCut {
  std::size_t pixel{};
  float distance_mm{};
  std::uint32_t cut{};
};

/// Calls `visit(pixel, distance_mm, cut)` for the pixels beside each cut within `reach_mm`, and
/// `beyond_mm` past its ends; the distance is that from the cut's line.
template <typename Visit>
void each_near_cut(std::span<const CutLine> cuts, const PixelFrame& frame, double reach_mm,
                   double beyond_mm, const Visit& visit) {
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const PagePoint& from = cuts[k].from;
    const PagePoint& to = cuts[k].to;
    const double length = distance(from, to);
    if (!(length > 0)) continue;
    const double ex = (to.x - from.x) / length, ey = (to.y - from.y) / length;
    const auto corner = [&](const PagePoint& p, double side) {
      return PagePoint{p.x - side * ey, p.y + side * ex};
    };
    const PagePoint a{from.x - beyond_mm * ex, from.y - beyond_mm * ey};
    const PagePoint b{to.x + beyond_mm * ex, to.y + beyond_mm * ey};
    const std::array<PagePoint, 4> band{corner(a, reach_mm), corner(b, reach_mm),
                                        corner(b, -reach_mm), corner(a, -reach_mm)};
    const auto of_triangle = [&](std::size_t i, std::size_t j, const std::array<double, 3>&) {
      const PagePoint p = frame.middle(i, j);
      const double off = std::abs((p.y - from.y) * ex - (p.x - from.x) * ey);
      visit(j * frame.width + i, off, k);
    };
    each_pixel(frame, {band[0], band[1], band[2]}, of_triangle);
    each_pixel(frame, {band[0], band[2], band[3]}, of_triangle);
  }
}

/// The pixels within `reach_mm` beside a cut, each with its nearest one, in order.
std::vector<NearCut> near_cuts(std::span<const CutLine> cuts, const PixelFrame& frame,
                               double reach_mm) {
  std::vector<NearCut> out;
  each_near_cut(cuts, frame, reach_mm, 0, [&](std::size_t pixel, double off, std::size_t cut) {
    out.push_back({pixel, static_cast<float>(off), static_cast<std::uint32_t>(cut)});
  });
  std::sort(out.begin(), out.end(), [](const NearCut& a, const NearCut& b) {
    if (a.pixel != b.pixel) return a.pixel < b.pixel;
    if (a.distance_mm != b.distance_mm) return a.distance_mm < b.distance_mm;
    return a.cut < b.cut;
  });
  out.erase(std::unique(out.begin(), out.end(),
                        [](const NearCut& a, const NearCut& b) { return a.pixel == b.pixel; }),
            out.end());
  return out;
}

PagePoint mirrored(const PagePoint& p, const CutLine& cut) {
  const double length = distance(cut.from, cut.to);
  const double ex = (cut.to.x - cut.from.x) / length, ey = (cut.to.y - cut.from.y) / length;
  const double along = (p.x - cut.from.x) * ex + (p.y - cut.from.y) * ey;
  return {2 * (cut.from.x + along * ex) - p.x, 2 * (cut.from.y + along * ey) - p.y};
}

void blend(ColourImage& image, std::span<const std::uint32_t> face, std::span<const CutLine> cuts,
           std::span<const NearCut> near, const PixelFrame& frame, double trap_mm) {
  std::vector<Colour> mixes(near.size());
  for (std::size_t n = 0; n < near.size(); ++n) {
    const std::size_t i = near[n].pixel % frame.width, j = near[n].pixel / frame.width;
    const Colour own = image.colour(i, j);
    mixes[n] = own;
    const PagePoint other = frame.in_pixels(mirrored(frame.middle(i, j), cuts[near[n].cut]));
    const double x = std::round(other.x), y = std::round(other.y);
    if (!(x >= 0 && y >= 0 && x < static_cast<double>(frame.width) &&
          y < static_cast<double>(frame.height)))
      continue;
    const auto across = static_cast<std::size_t>(x), down = static_cast<std::size_t>(y);
    const std::uint32_t there = face[down * frame.width + across];
    if (there == kNoFace || there == face[near[n].pixel]) continue;
    const Colour beyond = image.colour(across, down);
    if (own.a > 0 && beyond.a > 0)
      mixes[n] =
          mixed(beyond, own, 0.5F + 0.5F * near[n].distance_mm / static_cast<float>(trap_mm));
  }
  for (std::size_t n = 0; n < near.size(); ++n)
    image.set(near[n].pixel % frame.width, near[n].pixel / frame.width, mixes[n]);
}

/// Whether there is ink across a cut: beside it at the mirrored place, past its end at the place
/// that lies as far on the other side of the end.
bool has_ink_across(const ColourImage& image, const PagePoint& p, const CutLine& cut,
                    const PixelFrame& frame) {
  const double wx = cut.to.x - cut.from.x, wy = cut.to.y - cut.from.y;
  const double share = std::clamp(
      ((p.x - cut.from.x) * wx + (p.y - cut.from.y) * wy) / (wx * wx + wy * wy), 0.0, 1.0);
  const PagePoint other =
      frame.in_pixels({2 * (cut.from.x + share * wx) - p.x, 2 * (cut.from.y + share * wy) - p.y});
  const double x = std::round(other.x), y = std::round(other.y);
  return x >= 0 && y >= 0 && x < static_cast<double>(frame.width) &&
         y < static_cast<double>(frame.height) &&
         image.at(static_cast<std::size_t>(x), static_cast<std::size_t>(y))[3] > 0;
}

/// Lets colours go on from pixels of state 1 into those of state 0 beside them, `steps` pixels far.
/// Pixels of state 2 neither give nor take.
void spread(ColourImage& image, std::vector<std::uint8_t>& state, std::size_t steps) {
  const std::size_t width = image.width, height = image.height;
  const auto neighbours = [&](std::size_t pixel, auto&& visit) {
    const std::size_t i = pixel % width, j = pixel / width;
    if (i > 0) visit(pixel - 1);
    if (i + 1 < width) visit(pixel + 1);
    if (j > 0) visit(pixel - width);
    if (j + 1 < height) visit(pixel + width);
  };
  std::vector<std::size_t> edge, next;
  for (std::size_t pixel = 0; pixel < state.size(); ++pixel) {
    if (state[pixel] != 1) continue;
    bool beside = false;
    neighbours(pixel, [&](std::size_t other) { beside = beside || state[other] == 0; });
    if (beside) edge.push_back(pixel);
  }
  for (std::size_t step = 0; step < steps && !edge.empty(); ++step) {
    next.clear();
    for (const std::size_t pixel : edge)
      neighbours(pixel, [&](std::size_t other) {
        if (state[other] != 0) return;
        state[other] = 1;
        std::memcpy(&image.rgba[4 * other], &image.rgba[4 * pixel], 4);
        next.push_back(other);
      });
    edge.swap(next);
  }
}

/// Steps from pixel to pixel that lead `mm` far in every direction: on the diagonal a step leads
/// only half as far as two sides are long.
std::size_t steps_for(double mm, double pixel_mm) {
  return static_cast<std::size_t>(std::ceil(std::sqrt(2.0) * mm / pixel_mm)) + 1;
}

}  // namespace

ColourImage nearest_colours(const ColourMesh& mesh, const FaceSurface& surface,
                            const PixelFrame& frame, const Lighting& light,
                            std::span<const std::uint8_t> bare, const Progress& progress) {
  ColourImage image(frame.width, frame.height);
  const TriangleTree tree(mesh.soup);
  if (tree.size() == 0) return image;
  std::vector<float> lit(mesh.size());
  std::vector<double> texels(mesh.size());
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const Vec3 a = mesh.soup.corner(t, 0);
    const double area = 0.5 * norm(cross(mesh.soup.corner(t, 1) - a, mesh.soup.corner(t, 2) - a));
    texels[t] = texels_across(mesh, t, area / (frame.pixel_mm * frame.pixel_mm));
    lit[t] = static_cast<float>(brightness(mesh, t, light));
  }
  std::uint32_t hint = TriangleTree::kNone;
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    if (k % 64 == 0)
      tell(progress, "colouring the panels",
           static_cast<double>(k) / static_cast<double>(surface.triangles.size()));
    if (!bare.empty() && bare[surface.face[k]] != 0) continue;
    const auto& c = surface.triangles[k];
    const auto visit = [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
      if (image.at(i, j)[3] != 0) return;  // on a side that it has in common with another one
      const Vec3 p = w[0] * c[0].place + w[1] * c[1].place + w[2] * c[2].place;
      const TriangleTree::Nearest found = tree.nearest(p, hint);
      hint = found.place;
      const std::size_t t = tree.triangle_at(found.place);
      Colour colour = colour_of(mesh, t, weights_at(mesh.soup, t, found.point), texels[t]);
      colour.r *= lit[t], colour.g *= lit[t], colour.b *= lit[t];
      image.set(i, j, colour);
    };
    each_pixel(frame, {c[0].page, c[1].page, c[2].page}, visit);
  }
  return image;
}

ColourImage laid_flat(const Texture& image, const Box& box, const PixelFrame& frame) {
  ColourImage out(frame.width, frame.height);
  const double texels = std::max(static_cast<double>(image.width()) / box.width(),
                                 static_cast<double>(image.height()) / box.height()) *
                        frame.pixel_mm;
  for (std::size_t j = 0; j < frame.height; ++j)
    for (std::size_t i = 0; i < frame.width; ++i) {
      const PagePoint p = frame.middle(i, j);
      if (p.x < box.x0 || p.x > box.x1 || p.y < box.y0 || p.y > box.y1) continue;
      out.set(i, j, image.at((p.x - box.x0) / box.width(), (p.y - box.y0) / box.height(), texels));
    }
  return out;
}

std::vector<std::uint8_t> faces_of_card(const Pattern& pattern) {
  std::vector<std::uint8_t> out(pattern.faces(), 0);
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    bool wall = true, ground = true;
    for (const std::uint32_t i : pattern.face(f)) {
      wall = wall && pattern.vertices[i].x == 0;
      ground = ground && pattern.vertices[i].z == 0;
    }
    out[f] = wall || ground ? 1 : 0;
  }
  return out;
}

void trap(ColourImage& image, std::span<const std::uint32_t> face, std::span<const CutLine> cuts,
          std::span<const CutLine> borders, const PixelFrame& frame, const Trapping& how,
          bool blends) {
  for (std::size_t pixel = 0; pixel < face.size(); ++pixel)
    if (face[pixel] == kNoFace) std::memset(&image.rgba[4 * pixel], 0, 4);
  std::vector<std::uint8_t> state(face.size(), 2);
  if (how.trap_mm > 0) {
    if (blends) blend(image, face, cuts, near_cuts(cuts, frame, how.trap_mm), frame, how.trap_mm);
    // Ink into what is bare beside a cut.
    const double reach = how.trap_mm + frame.pixel_mm;
    for (std::size_t pixel = 0; pixel < face.size(); ++pixel)
      if (image.rgba[4 * pixel + 3] > 0) state[pixel] = 1;
    // Where a picture's outline crosses a line, the ink stays within the outline. The lines beside
    // a pixel decide that; lines that only point at it decide where there are none beside it.
    std::vector<std::uint8_t> beside(blends ? 0 : face.size(), 0);
    for (const bool past_ends : {false, true})
      for (const auto lines : {cuts, borders})
        each_near_cut(lines, frame, reach, past_ends ? reach : 0,
                      [&](std::size_t pixel, double, std::size_t cut) {
                        if (face[pixel] == kNoFace || state[pixel] != 2) return;
                        if (blends) return void(state[pixel] = 0);
                        if (past_ends && beside[pixel] != 0) return;
                        if (!past_ends) beside[pixel] = 1;
                        const PagePoint p = frame.middle(pixel % frame.width, pixel / frame.width);
                        if (has_ink_across(image, p, lines[cut], frame)) state[pixel] = 0;
                      });
    spread(image, state, steps_for(reach, frame.pixel_mm));
  }
  for (std::size_t pixel = 0; pixel < face.size(); ++pixel)
    state[pixel] = face[pixel] == kNoFace ? 0 : 1;
  spread(image, state, steps_for(std::max(how.bleed_mm, how.trap_mm), frame.pixel_mm));
}

void grow(ColourImage& image, std::size_t pixels) {
  std::vector<std::uint8_t> state(image.rgba.size() / 4);
  for (std::size_t pixel = 0; pixel < state.size(); ++pixel)
    state[pixel] = image.rgba[4 * pixel + 3] > 0 ? 1 : 0;
  spread(image, state, pixels);
}

}  // namespace popcut

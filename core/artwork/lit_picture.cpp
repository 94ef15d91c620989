// SPDX-License-Identifier: MIT
#include "core/artwork/lit_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/artwork/pixel_frame.hpp"

namespace popcut {
namespace lit_picture_parts {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();
constexpr std::size_t kFiner = 2;          // pixels are drawn in so many, across and down
constexpr std::size_t kLampPixels = 2048;  // of the lamp's own picture, across

/// A direction of parallel rays: places across and down, and depth, larger is nearer.
struct Rays {
  Vec3 toward, right, up;

  Rays(const Vec3& to, const Vec3& upward)
      : toward(unit(to)), right(unit(cross(upward, toward))), up(cross(toward, right)) {}
  [[nodiscard]] PagePoint place(const Vec3& p) const { return {dot(right, p), -dot(up, p)}; }
  [[nodiscard]] double depth(const Vec3& p) const { return dot(toward, p); }
};

std::array<Vec3, 3> corners_of(const ColourMesh& mesh, std::size_t t) {
  return {mesh.soup.corner(t, 0), mesh.soup.corner(t, 1), mesh.soup.corner(t, 2)};
}

/// The frame of `width` x `height` pixels around all that is seen, with `rim` of it left free on
/// each side.
PixelFrame frame_of(const ColourMesh& mesh, const Rays& rays, std::size_t width, std::size_t height,
                    double rim) {
  Box box;
  for (std::size_t t = 0; t < mesh.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) box.add(rays.place(mesh.soup.corner(t, k)));
  const auto w = static_cast<double>(width), h = static_cast<double>(height);
  const double pixel =
      std::max({box.width() / w, box.height() / h, 1e-9}) / std::max(0.1, 1 - 2 * rim);
  return {0.5 * (box.x0 + box.x1) - 0.5 * w * pixel, 0.5 * (box.y0 + box.y1) - 0.5 * h * pixel,
          pixel, width, height};
}

/// What is nearest at each pixel.
struct Nearest {
  PixelFrame frame;
  std::vector<float> depth_mm;
  std::vector<std::uint32_t> triangle;
  std::vector<std::array<float, 2>> weights;  ///< of the first two corners

  Nearest(const ColourMesh& mesh, const Rays& rays, const PixelFrame& of, bool depth_only)
      : frame(of), depth_mm(of.pixels(), kNothing) {
    if (!depth_only) triangle.resize(of.pixels()), weights.resize(of.pixels());
    for (std::size_t t = 0; t < mesh.size(); ++t) {
      const auto corner = corners_of(mesh, t);
      std::array<PagePoint, 3> at;
      std::array<double, 3> depth{};
      for (std::size_t k = 0; k < 3; ++k)
        at[k] = rays.place(corner[k]), depth[k] = rays.depth(corner[k]);
      each_pixel(frame, at, [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
        const std::size_t pixel = j * frame.width + i;
        const auto here = static_cast<float>(w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2]);
        if (!(here > depth_mm[pixel])) return;
        depth_mm[pixel] = here;
        if (depth_only) return;
        triangle[pixel] = static_cast<std::uint32_t>(t);
        weights[pixel] = {static_cast<float>(w[0]), static_cast<float>(w[1])};
      });
    }
  }
};

/// How much of the lamp's light reaches a place.
class Lamp {
 public:
  Lamp(const ColourMesh& mesh, const Rays& eye)
      : rays_(eye.toward + 0.35 * eye.up - 0.5 * eye.right, eye.up),
        seen_(mesh, rays_, frame_of(mesh, rays_, kLampPixels, kLampPixels, 0.01), true) {}

  /// 0: in shadow or turned away; 1: the lamp is right above it.
  [[nodiscard]] double light(const Vec3& place, const Vec3& normal) const {
    const double facing = dot(normal, rays_.toward);
    if (!(facing > 0)) return 0;
    // Off the surface, so that it does not shade itself, by more where it is seen from aside.
    const Vec3 p = place + (1.5 * seen_.frame.pixel_mm + 0.05) * normal;
    const PagePoint at = seen_.frame.in_pixels(rays_.place(p));
    const double depth = rays_.depth(p) + seen_.frame.pixel_mm;
    int lit = 0, count = 0;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx, ++count) lit += reaches(at.x + dx, at.y + dy, depth) ? 1 : 0;
    return facing * lit / count;
  }

 private:
  [[nodiscard]] bool reaches(double x, double y, double depth) const {
    const double last = static_cast<double>(kLampPixels) - 1;
    const auto i = static_cast<std::size_t>(std::clamp(std::round(x), 0.0, last));
    const auto j = static_cast<std::size_t>(std::clamp(std::round(y), 0.0, last));
    return !(static_cast<double>(seen_.depth_mm[j * kLampPixels + i]) > depth);
  }

  Rays rays_;
  Nearest seen_;
};

/// How much farther a pixel lies than its neighbours say, mm: 0 within a plane.
double behind_mm(const Nearest& seen, std::size_t i, std::size_t j) {
  const auto& frame = seen.frame;
  if (i == 0 || j == 0 || i + 1 == frame.width || j + 1 == frame.height) return 0;
  const std::size_t at = j * frame.width + i;
  double most = 0;
  for (const std::size_t step : {std::size_t{1}, frame.width}) {
    const float before = seen.depth_mm[at - step], after = seen.depth_mm[at + step];
    if (before == kNothing || after == kNothing) continue;
    most = std::max(most, static_cast<double>(before) + static_cast<double>(after) -
                              2.0 * static_cast<double>(seen.depth_mm[at]));
  }
  return most;
}

/// The colours of all pixels that show something, with opacity; the rest has none.
class Scene {
 public:
  Scene(const ColourMesh& mesh, const PictureLook& look)
      : mesh_(mesh),
        look_(look),
        rays_(look.toward, look.up),
        seen_(mesh, rays_,
              frame_of(mesh, rays_, kFiner * look.width_px, kFiner * look.height_px, 0.03), false),
        lamp_(mesh, rays_) {}

  [[nodiscard]] ColourImage drawn() const {
    ColourImage out(look_.width_px, look_.height_px);
    for (std::size_t j = 0; j < out.height; ++j)
      for (std::size_t i = 0; i < out.width; ++i) out.set(i, j, pixel(i, j));
    return out;
  }

 private:
  [[nodiscard]] Colour pixel(std::size_t i, std::size_t j) const {
    Colour sum{0, 0, 0, 255};
    for (std::size_t y = kFiner * j; y < kFiner * (j + 1); ++y)
      for (std::size_t x = kFiner * i; x < kFiner * (i + 1); ++x) {
        const Colour one = fine_pixel(x, y);
        sum.r += one.r, sum.g += one.g, sum.b += one.b;
      }
    constexpr float kCount = kFiner * kFiner;
    return {sum.r / kCount, sum.g / kCount, sum.b / kCount, 255};
  }

  [[nodiscard]] Colour fine_pixel(std::size_t i, std::size_t j) const {
    const std::size_t at = j * seen_.frame.width + i;
    if (seen_.depth_mm[at] == kNothing) return {};
    const std::size_t t = seen_.triangle[at];
    const auto a = static_cast<double>(seen_.weights[at][0]);
    const auto b = static_cast<double>(seen_.weights[at][1]);
    const std::array<double, 3> w{a, b, 1 - a - b};
    const auto p = corners_of(mesh_, t);
    const Vec3 place = w[0] * p[0] + w[1] * p[1] + w[2] * p[2];
    Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    const double pixels =
        0.5 * std::abs(dot(normal, rays_.toward)) / std::pow(seen_.frame.pixel_mm, 2);
    normal = unit(normal);
    const bool from_behind = dot(normal, rays_.toward) < 0;
    if (from_behind) normal = -normal;
    Colour colour = from_behind && look_.back
                        ? *look_.back
                        : colour_of(mesh_, t, w, texels_across(mesh_, t, pixels));
    double lit = 1 - look_.shade * (1 - lamp_.light(place, normal));
    const double rim_mm = 4 * kFiner * seen_.frame.pixel_mm;
    lit *= 1 - 0.45 * std::clamp(behind_mm(seen_, i, j) / rim_mm - 0.25, 0.0, 1.0);
    const auto share = static_cast<float>(lit);
    colour.r *= share, colour.g *= share, colour.b *= share;
    return colour;
  }

  const ColourMesh& mesh_;
  const PictureLook& look_;
  Rays rays_;
  Nearest seen_;
  Lamp lamp_;
};

}  // namespace
}  // namespace lit_picture_parts

ColourImage lit_picture(const ColourMesh& scene, const PictureLook& look) {
  if (scene.size() == 0) return on_paper(ColourImage(look.width_px, look.height_px));
  return lit_picture_parts::Scene(scene, look).drawn();
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include "core/artwork/model_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/artwork/pixel_frame.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {
double brightness(const ColourMesh& mesh, std::size_t triangle, const Lighting& light) {
  if (!(light.shade > 0)) return 1;
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = mesh.soup.corner(triangle, k);
    light.opening.to_space(p[k][0], p[k][2]);
  }
  Vec3 normal = unit(cross(p[1] - p[0], p[2] - p[0]));
  const Vec3 toward{1 + light.opening.cosine, 0, light.opening.sine};
  if (dot(normal, toward) < 0) normal = -normal;
  const Vec3 sun = unit(Vec3{0.45, -0.35, 0.82});
  return 1 - light.shade * (1 - std::max(0.0, dot(normal, sun)));
}

ColourImage view_of_model(const ColourMesh& mesh, double wall_mm, const PixelFrame& frame,
                          const Lighting& light) {
  ColourImage image(frame.width, frame.height);
  std::vector<float> nearest(frame.pixels(), -std::numeric_limits<float>::infinity());
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    std::array<Vec3, 3> corner;
    std::array<PagePoint, 3> at;
    std::array<double, 3> depth{};
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = mesh.soup.corner(t, k);
      at[k] = {corner[k][1], wall_mm + corner[k][0] - corner[k][2]};
      depth[k] = corner[k][0] + corner[k][2];
    }
    const double area = 0.5 * std::abs((at[1].x - at[0].x) * (at[2].y - at[0].y) -
                                       (at[1].y - at[0].y) * (at[2].x - at[0].x));
    const double texels = texels_across(mesh, t, area / (frame.pixel_mm * frame.pixel_mm));
    const auto lit = static_cast<float>(brightness(mesh, t, light));
    each_pixel(frame, at, [&](std::size_t i, std::size_t j, const std::array<double, 3>& w) {
      const auto here = static_cast<float>(w[0] * depth[0] + w[1] * depth[1] + w[2] * depth[2]);
      float& before = nearest[j * frame.width + i];
      if (!(here > before)) return;
      before = here;
      Colour colour = colour_of(mesh, t, w, texels);
      colour.r *= lit, colour.g *= lit, colour.b *= lit;
      image.set(i, j, colour);
    });
  }
  return image;
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include "core/artwork/colour_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {

Colour colour_of(const ColourMesh& mesh, std::size_t triangle, const std::array<double, 3>& weights,
                 double texels) {
  const Surfacing& how = mesh.surfacings[mesh.surfacing_of[triangle]];
  Colour colour = how.colour;
  if (how.texture >= 0) {
    double s = 0, t = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& at = mesh.st[3 * triangle + k];
      s += weights[k] * static_cast<double>(at[0]);
      t += weights[k] * static_cast<double>(at[1]);
    }
    const Colour texel = mesh.textures[static_cast<std::size_t>(how.texture)].at(s, t, texels);
    colour.r *= texel.r / 255, colour.g *= texel.g / 255, colour.b *= texel.b / 255;
  }
  if (!mesh.tint.empty()) {
    std::array<float, 3> tint{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        tint[c] += static_cast<float>(weights[k]) * mesh.tint[3 * triangle + k][c];
    colour.r *= tint[0], colour.g *= tint[1], colour.b *= tint[2];
  }
  colour.a = 255;
  return colour;
}

double texels_across(const ColourMesh& mesh, std::size_t triangle, double pixels) {
  const std::int32_t texture = mesh.surfacings[mesh.surfacing_of[triangle]].texture;
  if (texture < 0) return 0;
  const Texture& image = mesh.textures[static_cast<std::size_t>(texture)];
  const auto* p = &mesh.st[3 * triangle];
  const double area = 0.5 *
                      std::abs(static_cast<double>((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                                                   (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]))) *
                      static_cast<double>(image.width()) * static_cast<double>(image.height());
  return pixels > 0 ? std::sqrt(area / pixels) : 0;
}

std::vector<std::array<std::uint8_t, 3>> mean_colours(const ColourMesh& mesh,
                                                      std::size_t triangles) {
  std::vector<std::array<std::uint8_t, 3>> out;
  if (!mesh.coloured || mesh.size() != triangles) return out;
  out.reserve(mesh.size());
  constexpr double kThird = 1.0 / 3.0;
  const auto byte = [](float part) {
    return static_cast<std::uint8_t>(std::llround(std::clamp(part, 0.0F, 255.0F)));
  };
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    const Colour mean = colour_of(mesh, t, {kThird, kThird, kThird}, texels_across(mesh, t, 1.0));
    out.push_back({byte(mean.r), byte(mean.g), byte(mean.b)});
  }
  return out;
}

void make_clay(ColourMesh& mesh, const Colour& clay) {
  mesh.surfacings.assign(1, Surfacing{clay});
  mesh.surfacing_of.assign(mesh.size(), 0);
  mesh.st.clear(), mesh.tint.clear(), mesh.textures.clear();
  mesh.coloured = false;
}

}  // namespace popcut

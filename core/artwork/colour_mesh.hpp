// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/artwork/colour_image.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/design_angle.hpp"

namespace popcut {

/// How the triangles of one material are coloured.
struct Surfacing {
  Colour colour{};           ///< of all of it; a texture is multiplied by it
  std::int32_t texture{-1};  ///< an index of `ColourMesh::textures`, or none
};

/// A model as triangles with colours. A point's colour is the product of its material's colour, its
/// texture and its corners' own colours, each part by part in sRGB. (glTF multiplies light, not
/// sRGB; as sRGB is nearly a power of light, the products agree.)
struct ColourMesh {
  TriangleSoup soup;                        ///< corners (x, v, z), mm
  std::vector<std::array<float, 2>> st;     ///< three a triangle: place in its texture, t down
  std::vector<std::array<float, 3>> tint;   ///< three a triangle, 0 to 1; empty: all are 1
  std::vector<std::uint32_t> surfacing_of;  ///< one a triangle
  std::vector<Surfacing> surfacings;
  std::vector<Texture> textures;
  bool coloured{false};  ///< the file gives colours; else it is clay

  [[nodiscard]] std::size_t size() const { return soup.size(); }
};

/// The colour of the triangle's point with these weights of its corners.
///
/// @param texels  see `Texture::at`
[[nodiscard]] Colour colour_of(const ColourMesh& mesh, std::size_t triangle,
                               const std::array<double, 3>& weights, double texels);

/// How many pixels of its texture a triangle of the mesh covers, across, where it is drawn with an
/// area of `pixels`; 0 without a texture.
[[nodiscard]] double texels_across(const ColourMesh& mesh, std::size_t triangle, double pixels);

/// The mean colour of each triangle, in sRGB; of a picture on it, about its middle. Empty: the mesh
/// is clay, or has not all `triangles` of its file, since some are transparent. O(triangles).
[[nodiscard]] std::vector<std::array<std::uint8_t, 3>> mean_colours(const ColourMesh& mesh,
                                                                    std::size_t triangles);

inline constexpr Colour kClay{204, 160, 126, 255};

/// All of it in one colour: for models without colours, or to see the shape alone.
void make_clay(ColourMesh& mesh, const Colour& clay = kClay);

}  // namespace popcut

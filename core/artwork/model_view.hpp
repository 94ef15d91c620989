// SPDX-License-Identifier: MIT
#pragma once

#include "core/artwork/colour_image.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/pixel_frame.hpp"
#include "core/geometry/design_angle.hpp"

namespace popcut {

/// How light falls on a model: a share `shade` of its colour depends on how much the surface looks
/// to the light, which comes from above, from the left and from the front.
struct Lighting {
  double shade{0};        ///< 0: the colours as they are; 1: black where no light falls
  DesignAngle opening{};  ///< of the axes that the model's x and z are in
};

/// How bright a triangle of the model is, 0 to 1. Both of its sides are lit as the one that looks
/// to where the model is seen from.
[[nodiscard]] double brightness(const ColourMesh& mesh, std::size_t triangle,
                                const Lighting& light);

/// A model as it is seen from the direction (1, 0, 1), half way between ground and wall, by
/// parallel rays, stretched along u so that it lies on the flat sheet (docs/geometry.md, section
/// 2): the point (X, v, Z) of the model is at x = v, y = u = H + X - Z of the page, and of several
/// points there the one with the largest X + Z is seen. This is the picture for every pop-up whose
/// panels are parallel to wall and ground. Where the model is not, the image has no ink.
///
/// Each pixel has the colour of the point in its middle. O(pixels that triangles cover).
///
/// @param mesh     x and z are those of the section, v is that of the sheet, mm
/// @param wall_mm  H
/// @param frame    of the page of the pattern: x = v, y = u
[[nodiscard]] ColourImage view_of_model(const ColourMesh& mesh, double wall_mm,
                                        const PixelFrame& frame, const Lighting& light);

}  // namespace popcut

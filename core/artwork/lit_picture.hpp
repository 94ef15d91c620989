// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>

#include "core/artwork/colour_image.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {

/// From where a scene is seen without perspective, and how it is lit.
struct PictureLook {
  Vec3 toward{1, 0, 1};  ///< from the scene to the eye; not along `up`
  Vec3 up{0, 0, 1};      ///< as far as it can be, this is up in the picture
  std::size_t width_px{480}, height_px{480};
  double shade{0.35};            ///< share of a colour that depends on the lamp, 0 to 1
  std::optional<Colour> back{};  ///< of triangles that are seen from behind; none: their own
};

/// A picture of a scene under one lamp, which hangs above, to the left and in front of it, and
/// throws shadows. The scene fills the picture, and white is around it. Where the depth jumps, the
/// farther side has a thin dark rim. A triangle's front is where it runs counter-clockwise.
///
/// O(pixels that triangles cover), of four a pixel of the picture and four million of the lamp's.
///
/// @param scene  (x, v, z) in space, mm; without triangles the picture is white
[[nodiscard]] ColourImage lit_picture(const ColourMesh& scene, const PictureLook& look);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/artwork/pixel_frame.hpp"
#include "core/geometry/vec.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// A flat sheet's faces as triangles on the page of the pattern (x = v, y = u), each corner with
/// its place in space when the card is opened as it was designed.
struct FaceSurface {
  struct Corner {
    PagePoint page;
    Vec3 place;  ///< (x, v, z), mm
  };
  std::vector<std::array<Corner, 3>> triangles;
  std::vector<std::uint32_t> face;  ///< of each triangle
};

/// @retval OutOfRange  a face is not a simple polygon with an area; `place` is "faces/N"
[[nodiscard]] Result<FaceSurface> face_surface(const Pattern& pattern);

/// Which face each pixel's middle lies in: its number, or `kNoFace`. On a border one of the two.
inline constexpr std::uint32_t kNoFace = 0xFFFFFFFF;
[[nodiscard]] std::vector<std::uint32_t> face_pixels(const FaceSurface& surface,
                                                     const PixelFrame& frame);

/// A straight cut of the pattern on its page: a slit, or a part of the outline. Each once.
struct CutLine {
  PagePoint from, to;
};
[[nodiscard]] std::vector<CutLine> cut_lines(const Pattern& pattern);
/// Its folds, in the same form.
[[nodiscard]] std::vector<CutLine> fold_lines_on_page(const Pattern& pattern);

}  // namespace popcut

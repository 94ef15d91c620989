// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/compare/depth_image.hpp"
#include "core/compare/view.hpp"

namespace popcut::likeness {

/// A volume, or why there is none.
struct Volume {
  bool ran{false};
  double mm3{};
  std::string why;  ///< one sentence, where it did not run

  /// A ray that leaves as often as it enters tells inside from outside by winding numbers; where
  /// triangles face either way, by counting alone.
  bool by_winding{false};
};

/// The volume of a solid in front of the corner, by columns along the diagonal: each ray's
/// stretches inside, summed. Parts that lie in each other count once.
///
/// A mesh has an inside if every ray leaves it as often as it enters it, seen from three
/// directions; up to 1 ray in 1000 may not (edges that meet without a common corner), and is left
/// out.
///
/// @param pixels  along each side of the grid of columns
[[nodiscard]] Volume solid_volume(Triangles triangles, const Corner& corner, int pixels);

/// The volume between a surface and the corner behind it, mm^3, both seen along the diagonal: what
/// is behind the nearest triangle counts as filled.
[[nodiscard]] double volume_before(Triangles surface, const Corner& corner, int pixels);

}  // namespace popcut::likeness

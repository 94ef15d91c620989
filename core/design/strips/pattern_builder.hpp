// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"
#include "core/rigid/mobility.hpp"

namespace popcut {

/// A fold of the section plane: the faces on its wall side and on its ground side, and where it is.
struct Hinge {
  std::int32_t from_face{};
  std::int32_t to_face{};
  double x{}, z{};
};

/// A pattern and what the figures need to know of how its faces came about.
struct BuiltPattern {
  Pattern pattern;
  std::vector<std::int32_t> panel_face;  ///< rigid face of each panel of the strips
  std::vector<std::uint8_t> upright;     ///< one a face: 1 parallel to the wall, 0 to the ground
  std::vector<Hinge> hinges;             ///< one a fold line

  /// The faces and folds seen along the spine.
  [[nodiscard]] rigid::Section section() const;
};

/// Turns strips into faces, folds and cuts (docs/geometry.md, section 4): panels of neighbouring
/// strips in the same plane are joined where they overlap, and cut along the rest of their edge.
/// O(panels).
///
/// A panel of `kNoPlane` that has a length is a window: no paper. A face around it must be open
/// somewhere, since faces have no holes: `parted` sees to that.
///
/// @param min_panel_mm  overlaps that are shorter are cut too (`is_joint`)
/// @param parted        panels that are cut from the strip before theirs, though in one plane
///
/// @retval Internal  the strips do not make simple faces (a fault of the strips' builder)
[[nodiscard]] Result<BuiltPattern> build_pattern(const Strips& strips, double wall_mm,
                                                 double ground_mm, bool card,
                                                 double min_panel_mm = 0.0,
                                                 std::span<const std::uint32_t> parted = {});

}  // namespace popcut

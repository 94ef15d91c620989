// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "core/design/target/curve.hpp"

namespace popcut {

/// A straight piece of a section's boundary.
struct SectionSegment {
  SectionPoint a, b;
};

/// The boundary of a target in one plane v = s, in no order, within the corner x >= 0, z >= 0.
struct Section {
  std::vector<SectionSegment> segments;
  std::vector<SectionPoint> open_ends;  ///< where the boundary ends inside the corner: a hole
};

/// Adds the part of a piece that lies in the corner, less what lies on wall or ground themselves;
/// `touch_mm` is what counts as on them.
void add_clipped(Section& section, SectionPoint a, SectionPoint b, double touch_mm);

/// A point of an outline and the length of boundary that it stands for.
struct OutlinePoint {
  SectionPoint p;
  double weight_mm{};
};

/// What of a section is seen from outside the corner, looking along (-1, -1): for each x - z the
/// boundary's point with the largest x + z. What is seen only through a gap that is less than half
/// as wide as what lies behind it is deep does not count as seen.
struct Outline {
  std::vector<OutlinePoint> points;  ///< from wall to ground, by x - z
  double length_mm{};                ///< of the whole section's boundary in the corner
  double visible_mm{};               ///< of the part that is seen
  double size_mm{};                  ///< x plus z of the corner's box around it
  double gap_mm{};                   ///< longest way from one seen part to the next
  SectionPoint gap_at;               ///< where it begins
  std::optional<SectionPoint> hole;  ///< an open end that is seen
};

/// The outline, sampled at least `samples` times over its extent. Its cost is O(k log k) for k
/// pieces. Empty points: nothing of the section is in the corner.
[[nodiscard]] Outline seen_from_outside(const Section& section, int samples = 512);

}  // namespace popcut

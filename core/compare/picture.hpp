// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/compare/comparison.hpp"
#include "core/compare/depth_image.hpp"

namespace popcut::likeness {

using Rgb = std::array<std::uint8_t, 3>;

/// A square picture: three bytes a pixel, row by row from above.
struct Pixels {
  int size{};
  std::vector<std::uint8_t> rgb;
};

/// What a model and the paper of a card are drawn in.
inline constexpr Rgb kModelColour{196, 205, 214}, kPaperColour{250, 236, 206};

/// Depths as a surface of one colour under a lamp at the upper left, its contours drawn dark, on
/// white. `jump_mm` as in `find_contours`.
[[nodiscard]] Pixels shaded(const DepthImage& image, double pitch_mm, float jump_mm,
                            const Rgb& colour);

/// What `difference` is drawn in, for a legend.
inline constexpr Rgb kAgrees{244, 244, 240};
inline constexpr Rgb kNearer{33, 102, 172};   ///< the structure stands `kFullColour` in front
inline constexpr Rgb kFarther{178, 24, 43};   ///< and that far behind
inline constexpr Rgb kMissing{84, 39, 136};   ///< only the target is there
inline constexpr Rgb kBeyond{246, 214, 120};  ///< only the structure is
inline constexpr double kFullColour = 0.1;    ///< of the target's diagonal

/// Where view `k` of a structure, `Target::draw_view`, differs from the target.
[[nodiscard]] Pixels difference(const Target& target, std::size_t k, const DepthImage& structure);

}  // namespace popcut::likeness

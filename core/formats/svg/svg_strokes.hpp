// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/svg_region.hpp"
#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_transform.hpp"
#include "core/result.hpp"

namespace popcut {

/// The frame of a nested <svg> or <symbol>, which hides what is outside it.
struct SvgClip {
  SvgTransform to_page, from_page;
  Box box;                  ///< in the frame's own units
  const SvgClip* around{};  ///< the frame that this one lies in
};

/// Collects strokes on the page, within the limits. Its errors have no place.
class SvgStrokes {
 public:
  SvgStrokes(LineWork& work, std::size_t most_points) : work_(work), most_points_(most_points) {}

  /// Adds each line except those without length. Returns how many it added.
  ///
  /// @retval OutOfRange  too many points, or more than 100 m from the origin
  [[nodiscard]] Result<std::size_t> add(const SvgLines& lines, const SvgTransform& to_page,
                                        PenOperation operation);

  /// Appends the dashes of each line to `out`. `dashes` and `lines` have the same unit. Work is
  /// taken from `steps`.
  ///
  /// @retval OutOfRange  the dashes are too fine for a line
  [[nodiscard]] Result<void> dash(const SvgLines& lines, const SvgDashes& dashes,
                                  std::size_t& steps, SvgLines& out) const;

  /// Removes from the lines from number `first` on what is outside the frame or a frame around it.
  /// Returns how many lines lost something.
  std::size_t clip(const SvgClip& frame, std::size_t first);

  /// The same for what is outside a region; work is taken from `steps`.
  std::size_t clip(const SvgRegion& region, std::size_t first, std::size_t& steps);

 private:
  LineWork& work_;
  std::size_t most_points_;
};

/// Clip paths that hold for an element, the innermost first.
struct SvgClipPath {
  const SvgRegion* region{};
  const SvgClipPath* around{};
};

/// What the inside of closed lines on the page shows within its frames and clip paths, as closed
/// lines. None if nothing is hidden. Work is taken from `steps`.
[[nodiscard]] std::optional<SvgLines> clipped_fill(const SvgLines& lines, bool even_odd,
                                                   const SvgClip* frame, const SvgClipPath* clips,
                                                   std::size_t& steps);

/// Lines on the page: each point of `lines` mapped by `to_page`.
[[nodiscard]] SvgLines moved(const SvgLines& lines, const SvgTransform& to_page);

/// Removes closed lines without area, which a fill does not show.
void remove_thin_lines(SvgLines& lines);

/// Removes the lines with the numbers `which` (ascending) from `work`.
void remove_lines(LineWork& work, std::span<const std::size_t> which);

}  // namespace popcut

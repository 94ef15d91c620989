// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_transform.hpp"
#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut {

/// The frame of a nested <svg> or <symbol>, which hides what leaves it.
struct SvgClip {
  SvgTransform to_page, from_page;
  Box box;                  ///< in the frame's own units
  const SvgClip* around{};  ///< the frame that this one lies in
};

/// Collects strokes on the page, within the limits. Its errors have no place.
class SvgStrokes {
 public:
  SvgStrokes(LineWork& work, std::size_t most_points) : work_(work), most_points_(most_points) {}

  /// Adds each line; those without length are left out. Returns how many were added.
  ///
  /// @retval OutOfRange  too many points, or farther than 100 m from the origin
  [[nodiscard]] Result<std::size_t> add(const SvgLines& lines, const SvgTransform& to_page,
                                        Operation operation);

  /// The dashes of each line; `dashes` and `lines` are measured alike. Work is taken off `steps`.
  ///
  /// @retval OutOfRange  the dashes are too fine for a line
  [[nodiscard]] Result<void> dash(const SvgLines& lines, const SvgDashes& dashes,
                                  std::size_t& steps, SvgLines& out) const;

  /// Cuts off what of the lines from `first` on leaves the frame or one around it. Returns how many
  /// lines lost something.
  std::size_t clip(const SvgClip& frame, std::size_t first);

 private:
  LineWork& work_;
  std::size_t most_points_;
};

/// Lines on the page: each point of `lines` moved by `to_page`.
[[nodiscard]] SvgLines moved(const SvgLines& lines, const SvgTransform& to_page);

/// Takes closed lines that enclose no area away: a fill does not show them.
void remove_thin_lines(SvgLines& lines);

/// Takes the lines `which` (rising) out of `work`.
void remove_lines(LineWork& work, std::span<const std::size_t> which);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// The outline of one filled shape: lines `first` to `first + count` of a drawing.
struct FilledShape {
  std::size_t first{}, count{};
  bool even_odd{false};
};

/// Which of the shapes, by 1, have an outline that crosses that of another one, or itself if the
/// rule is nonzero; none if more than `steps` comparisons would be needed. Outlines that only touch
/// do not cross.
///
/// @param enlarged  times that the drawing becomes larger afterwards
[[nodiscard]] std::vector<std::uint8_t> crossing_shapes(const LineWork& work,
                                                        std::span<const FilledShape> shapes,
                                                        std::size_t steps, double enlarged);

/// Replaces the outlines of shapes that lie over each other, of the same operation and pen, by the
/// outline of all of them together; and those of a shape of several lines, or one whose outline
/// crosses itself, by the outline of what it fills. Work is taken from `steps`; with none left the
/// drawing means nothing. Returns how many shapes became part of another.
///
/// @param crossing  as `crossing_shapes`
std::size_t weld_shapes(LineWork& work, std::span<const FilledShape> shapes,
                        std::span<const std::uint8_t> crossing, std::size_t& steps);

}  // namespace popcut

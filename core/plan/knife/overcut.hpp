// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// How far to cut a closed path past its seam at either end: `wanted_mm`, but at most a quarter of
/// its length `round_mm`.
[[nodiscard]] double overcut_for(double round_mm, double wanted_mm);

/// Whether such a line gets an overcut: closed cuts and outlines do.
[[nodiscard]] bool takes_overcut(Operation operation, std::span<const PagePoint> points);

/// Appends the first or the last `mm` of a line, in the line's direction.
void append_head(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out);
void append_tail(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out);

/// Appends a closed path that begins `overcut_mm` before its seam and ends as far past it.
void append_with_overcut(std::span<const PagePoint> points, double overcut_mm,
                         std::vector<PagePoint>& out);

/// Length of one round of a closed path that has `passes` rounds, mm.
[[nodiscard]] double round_mm(std::span<const PagePoint> points, int passes);

}  // namespace popcut

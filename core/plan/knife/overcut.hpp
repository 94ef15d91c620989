// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/drawing/linework.hpp"

namespace popcut {

/// How far a closed path is cut beyond its seam at either end: `wanted_mm`, but no more than a
/// quarter of its way round (`round_mm`). Each path has its own.
[[nodiscard]] double overcut_for(double round_mm, double wanted_mm);

/// Whether lines of this kind are overcut: closed cuts and outlines.
[[nodiscard]] bool takes_overcut(Operation operation, std::span<const PagePoint> points);

/// The first `mm` of a line, or the last ones (in the line's own direction).
void append_head(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out);
void append_tail(std::span<const PagePoint> points, double mm, std::vector<PagePoint>& out);

/// A closed path that begins `overcut_mm` before its seam and ends as far behind it.
void append_with_overcut(std::span<const PagePoint> points, double overcut_mm,
                         std::vector<PagePoint>& out);

/// One round of a closed path that goes round `passes` times.
[[nodiscard]] double round_mm(std::span<const PagePoint> points, int passes);

}  // namespace popcut

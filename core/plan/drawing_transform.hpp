// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/layout/sheet.hpp"
#include "core/plan/plan_options.hpp"

namespace popcut {

/// The map that the options `mirror`, `rotate`, `scale` and `width` ask for: first the mirror image
/// (left and right exchanged), then the turn (clockwise, as seen on the page), then the size.
/// `width` is that of the bounding box of the result; without extent across it has no effect.
[[nodiscard]] Placement drawing_transform(const LineWork& drawing, const PlanOptions& options);

/// Whether it changes anything.
[[nodiscard]] bool is_identity(const Placement& map);

/// The drawing with all points moved by `map`. A mirror image is the sheet seen from behind, so its
/// mountain and valley folds are exchanged: what is folded from it is the same piece. The drawing's
/// place on its page no longer counts.
[[nodiscard]] LineWork transformed(LineWork drawing, const Placement& map);

/// Where `count` copies of a drawing lie beside each other on `reach_mm` (across and along): rows
/// of equal cells with `gap_mm` between them, as many in a row as fit. The first is at 0, 0.
///
/// @retval Infeasible  not so many fit; the detail says how many do
[[nodiscard]] Result<std::vector<PagePoint>> copies_at(const LineWork& drawing, int count,
                                                       std::array<double, 2> reach_mm,
                                                       double gap_mm);

/// The drawing once at each of these places; its place on its page no longer counts. The drawing
/// itself if there are none.
[[nodiscard]] LineWork copied(LineWork drawing, std::span<const PagePoint> places);

/// The drawing with a box around it, `mm` from its bounding box, that is cut last: what is left of
/// a vinyl sheet is then weeded in one piece. Unchanged if `mm` is 0.
[[nodiscard]] LineWork with_weed_box(LineWork drawing, double mm);

/// How far curves may lie from the lines that replace them when a drawing is read, mm of the
/// drawing: on the sheet, after `scale`, this is `curve_tolerance_mm`. The scale that `width` makes
/// is known only then.
[[nodiscard]] double reading_tolerance_mm(const PlanOptions& options);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/judge/glue_guide.hpp"
#include "core/print/pages.hpp"
#include "core/result.hpp"

namespace popcut {

/// The pages of a guide to a card of several parts, six steps on each. A fold step shows the part
/// half folded, and flat with its folds and the letters of its tabs. A glue step shows the card as
/// far as it is glued, with the new part lit and its tabs orange, and what they are glued on with
/// their outlines.
///
/// @param page_mm  width and height of the paper
/// @retval OutOfRange  as `step_pages`
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::vector<PrintedPage>> glue_guide_pages(const judge::GlueGuide& guide,
                                                                std::array<double, 2> page_mm);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/hands/fold_guide.hpp"
#include "core/print/pages.hpp"
#include "core/result.hpp"

namespace popcut {

/// So many folds have one page.
inline constexpr std::size_t kFoldsAPage = 40;

/// The pages of a fold guide: for each step its words, the standing card from the side that shows
/// its panels best, with them lit, and its part of the sheet with its folds drawn strongly. One
/// page for each `kFoldsAPage` folds, at least one.
///
/// @param page_mm  width and height of the paper
/// @retval OutOfRange  the paper is smaller than A6 or larger than PDF allows ("page")
[[nodiscard]] Result<std::vector<PrintedPage>> fold_guide_pages(const Pattern& pattern,
                                                                const hands::FoldGuide& guide,
                                                                std::array<double, 2> page_mm);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/print/pages.hpp"
#include "core/result.hpp"

namespace popcut {

/// A part of a page, mm from its upper left corner.
struct PageCell {
  double x{}, y{}, width{}, height{};
};

/// The frame of a step in its cell, its number and its words, as SVG elements. `rest` gets what is
/// left below them for pictures.
[[nodiscard]] std::string step_words_svg(std::size_t number, const std::string& words,
                                         const PageCell& cell, PageCell& rest);

/// Pages of steps in cells, at most `a_page` on each; at least one page. Cells are not higher than
/// wide.
///
/// @param name     "How to fold house"
/// @param page_mm  width and height of the paper
/// @param draw     a step in its cell, as SVG elements
/// @retval OutOfRange  the paper is smaller than A6 or larger than PDF allows ("page"); else as
///                     `draw`
[[nodiscard]] Result<std::vector<PrintedPage>> step_pages(
    const std::string& name, std::array<double, 2> page_mm, std::size_t steps, std::size_t a_page,
    const std::function<Result<std::string>(std::size_t, const PageCell&)>& draw);

}  // namespace popcut

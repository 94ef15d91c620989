// SPDX-License-Identifier: MIT
#pragma once

#include <iterator>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/figures/paper_figures.hpp"

namespace popcut::figures {

/// Adds one figure's files and statements to the whole.
Result<void> add_assembly_figures(PaperFigures& out);  // 1C, 1D, S5
Result<void> add_slice_figures(PaperFigures& out);     // 2C
Result<void> add_splay_figures(PaperFigures& out);     // 3C, 3D

/// Adds a line to a table.
template <typename... Values>
void add_row(std::string& csv, fmt::format_string<Values...> row, Values&&... values) {
  fmt::format_to(std::back_inserter(csv), row, std::forward<Values>(values)...);
}

inline void state(PaperFigures& out, std::string figure, std::string claim, double value,
                  bool holds) {
  out.statements.push_back({std::move(figure), std::move(claim), value, holds});
}

}  // namespace popcut::figures

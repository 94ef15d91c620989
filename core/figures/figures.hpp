// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/figures/paper_figures.hpp"
#include "core/figures/plot.hpp"

namespace popcut::figures {

/// Adds one figure's files and statements to the whole.
Result<void> add_assembly_figures(PaperFigures& out);  // 1C, 1D, S5
Result<void> add_slice_figures(PaperFigures& out);     // 2C
Result<void> add_splay_figures(PaperFigures& out);     // 3C, 3D

/// A map panel of an assembly, K or H.
[[nodiscard]] plot::Panel assembly_panel(const AssemblyMaps& maps, bool gaussian,
                                         std::string title);

inline void state(PaperFigures& out, std::string figure, std::string claim, double value,
                  bool holds) {
  out.statements.push_back({std::move(figure), std::move(claim), value, holds});
}

}  // namespace popcut::figures

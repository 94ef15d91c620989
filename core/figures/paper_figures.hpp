// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// A published or derived statement, checked with popcut's own numbers.
struct CheckedStatement {
  std::string figure;  ///< "1C"
  std::string claim;   ///< in words, with what is required of `value`
  double value{};
  bool holds{};
};

struct FigureFile {
  std::string name;
  std::string content;
};

/// The paper's figures that can be computed, as SVG, and their numbers as CSV beside each.
struct PaperFigures {
  std::vector<FigureFile> files;
  std::vector<CheckedStatement> statements;
  [[nodiscard]] bool all_hold() const;
};

/// Computes and draws Fig. 1C and 1D (K and H of the five-unit assembly), 2C top (azimuthal error,
/// both conventions) and bottom (loss against L/N), 3C (theta of a splayed unit), 3D (K of a
/// splayed patch as it opens) and S5 (the maps with their minimisers, and K and H over r, lambda
/// and phi).
///
/// @retval Infeasible  a chain or an assembly that the figures need has no solution
[[nodiscard]] Result<PaperFigures> paper_figures();

/// `{"all_hold": …, "statements": [{"figure", "claim", "value", "holds"}], "files": […]}`.
[[nodiscard]] std::string figures_json(const PaperFigures& figures);

}  // namespace popcut

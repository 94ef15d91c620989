// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/compare/printed.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// How a printed card of several parts looks beside its model.
struct ComparedParts {
  likeness::PrintedFigures printed;  ///< `judge::layers_likeness` or `judge::boxes_likeness`
  bool opens_flat{};                 ///< seen from above its pages, else from around the diagonal
};

/// Whether a file is the FOLD file of a card of several parts. False, too, if it cannot be read.
[[nodiscard]] bool is_card_of_parts(const std::string& file);

/// Compares a card of several parts, printed, with the model of its design.
///
/// @param pattern  its FOLD file
/// @param design   the spec that it was designed from
/// @retval OutOfRange  `design` is no design, its style is not one that is printed with colours, or
///                     it makes another card; else as `layered_card` and `judge::sound_boxes`
[[nodiscard]] Result<ComparedParts> compare_parts(const std::string& pattern,
                                                  const std::string& design, int pixels,
                                                  const Progress& progress);

}  // namespace popcut::cli

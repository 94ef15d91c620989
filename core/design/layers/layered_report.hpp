// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/compare/printed.hpp"
#include "core/design/layers/layered_card.hpp"

namespace popcut {

/// The `report.json` of a card of layers.
///
/// @param printed  how it looks printed
[[nodiscard]] std::string layered_report_json(const LayeredCard& made,
                                              const likeness::PrintedFigures& printed,
                                              double seconds);

}  // namespace popcut

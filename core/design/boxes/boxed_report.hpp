// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/compare/printed.hpp"
#include "core/design/boxes/boxed_card.hpp"

namespace popcut {

/// "flat", "gabled", "pyramid" or "tent".
[[nodiscard]] const char* roof_word(const Block& block);

/// The `report.json` of a card of boxes.
///
/// @param printed  how it looks printed
[[nodiscard]] std::string boxed_report_json(const BoxedCard& made,
                                            const likeness::PrintedFigures& printed,
                                            double seconds);

}  // namespace popcut

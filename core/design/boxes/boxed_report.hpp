// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/boxes/boxed_card.hpp"

namespace popcut {

/// "flat", "gabled", "pyramid" or "tent".
[[nodiscard]] const char* roof_word(const Block& block);

/// The `report.json` of a card of boxes.
[[nodiscard]] std::string boxed_report_json(const BoxedCard& made, double seconds);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/layers/layered_card.hpp"

namespace popcut {

/// The `report.json` of a card of layers.
[[nodiscard]] std::string layered_report_json(const LayeredCard& made, double seconds);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/slices/sliced_card.hpp"

namespace popcut {

/// The steps in which the pieces are put together, each the names of its pieces in order.
[[nodiscard]] std::vector<std::vector<std::string>> assembly_steps(const SlicedCard& made);

/// The `report.json` of a card of slices.
[[nodiscard]] std::string sliced_report_json(const SlicedCard& made, double seconds);

}  // namespace popcut

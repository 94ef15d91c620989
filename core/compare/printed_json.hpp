// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "core/compare/printed.hpp"

namespace popcut::likeness {

/// The `printed` of a report.
[[nodiscard]] inline nlohmann::ordered_json printed_json(const PrintedFigures& printed) {
  return {{"looks", name_of(looks(printed))},
          {"error", printed.error()},
          {"colour", printed.colour},
          {"contour", printed.contour},
          {"cover", printed.cover}};
}

}  // namespace popcut::likeness

// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/plan.hpp"

namespace popcut {

/// The text of `plan.json`: sheets with their figures in mm and seconds, warnings, and the seed.
/// `transform` is [[xx, xy, x0], [yx, yy, y0]], from the pattern's page (x = v, y = u, mm) to the
/// sheet.
[[nodiscard]] std::string plan_json(const Plan& plan);

}  // namespace popcut

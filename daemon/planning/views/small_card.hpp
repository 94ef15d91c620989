// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/pattern/pattern.hpp"

namespace popcut::planning {

/// A small picture of opened cards side by side, each at the angle that it is designed for: an SVG
/// of at most 60 kB or so, for which strips and steps are drawn wider. Its title has the names of
/// the patterns.
[[nodiscard]] std::string small_card_svg(const std::vector<const Pattern*>& parts);

}  // namespace popcut::planning

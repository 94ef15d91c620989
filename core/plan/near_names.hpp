// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace popcut {

/// Number of single-letter insertions, deletions and replacements between two words; each is cut
/// to 64 letters first.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);

/// "did you mean cameo3?" with the nearest of `names`, or "one of a, b, c" where none is near.
[[nodiscard]] std::string suggestion(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace popcut

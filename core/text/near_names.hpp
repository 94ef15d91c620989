// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace popcut {

/// "did you mean cameo3?" with the nearest of `names`, or "one of a, b, c" where none is near.
[[nodiscard]] std::string suggestion(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace popcut

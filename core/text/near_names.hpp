// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace popcut {

/// The name nearest to `wrong` when it is near enough to be what was meant, else empty.
[[nodiscard]] std::string nearest_word(std::string_view wrong,
                                       const std::vector<std::string>& names);

/// "did you mean cameo3?" with the nearest of `names`, or those that contain it if they are few;
/// "one of a, b, c" where none is near.
[[nodiscard]] std::string suggestion(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace popcut

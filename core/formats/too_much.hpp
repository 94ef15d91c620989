// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut {

/// How each error ends that is about a limit of the readers of drawings: what helps always. Who
/// knows a way to raise the limits adds it.
inline constexpr std::string_view kSimplify = "simplify the drawing";

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>

#include "core/result.hpp"

namespace popcut {

/// The error of a drawing that is over a limit of its reader, with what helps always. Who knows a
/// way to raise the limits adds it (`ErrorReason::TooMuch`).
///
/// @param what  "the drawing has more than 5 points"
[[nodiscard]] inline Error too_much(std::string what) {
  return {ErrorKind::OutOfRange, "", std::move(what) + "; simplify the drawing",
          ErrorReason::TooMuch};
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include "core/result.hpp"

namespace popcut::pictures {

/// Loads the libraries that draw pictures, at the first call. Each function that draws calls it by
/// itself; a process that gives up its files calls it before.
///
/// @retval Internal  librsvg or one of its functions is missing; the detail names the package
[[nodiscard]] Result<void> load_graphics();

}  // namespace popcut::pictures

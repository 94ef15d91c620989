// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/compare/comparison.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// A picture (PNG) of three views, a row each: the model, the structure, and where they differ.
///
/// @param structure  all of it, the card too, which is drawn but not compared
/// @param title      above the picture
/// @retval Internal  the libraries cannot draw it
[[nodiscard]] Result<std::string> compare_picture(const likeness::Target& target,
                                                  likeness::Triangles model,
                                                  likeness::Triangles structure,
                                                  const std::string& title);

}  // namespace popcut::cli

// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/linework.hpp"

namespace popcut {

/// What is cut to try a material: a square of 10 mm with a triangle in it, that must fall out
/// whole, and a fold of 10 mm beside it, that must bend and hold.
[[nodiscard]] LineWork test_shape();

}  // namespace popcut

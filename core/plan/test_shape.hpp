// SPDX-License-Identifier: MIT
#pragma once

#include "core/drawing/linework.hpp"

namespace popcut {

/// A test cut for a material: a square of 10 mm with a triangle inside, which must fall out in one
/// piece, and beside it a fold of 10 mm, which must bend without tearing.
[[nodiscard]] LineWork test_shape();

}  // namespace popcut

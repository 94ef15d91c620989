// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Writes a drawing as a FOLD file without faces, one edge per straight line, for verify to trace.
/// The frame is (u, v) = (page y, page x) in mm, seen from the pop-up side. Cuts and outlines are C
/// (tracing the faces finds the borders among them), folds M and V, scores U. Pen lines are left
/// out.
[[nodiscard]] std::string fold_from_linework(const LineWork& work);

}  // namespace popcut

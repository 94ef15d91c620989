// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/drawing/linework.hpp"

namespace popcut {

/// A drawing as a FOLD file without faces: one edge a straight line, as it is drawn, for verify to
/// make a sheet of. The frame is (u, v) = (page y, page x) in mm, seen from the pop-up side. Cuts
/// and outlines are C (tracing the faces tells which of them are borders), folds M and V, scores U;
/// what is only drawn is left out.
[[nodiscard]] std::string fold_from_linework(const LineWork& work);

}  // namespace popcut

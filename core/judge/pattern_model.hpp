// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"
#include "core/verify/sheet/fold_model.hpp"

namespace popcut::judge {

/// What the verifier reads from the FOLD file of a pattern (`write_fold`, split form, with these
/// poses), without the text between them: the same numbers, indices and places. O(vertices).
///
/// @retval Internal    a coordinate is not finite
/// @retval OutOfRange  what the verifier's reader refuses: an edge or a side between a vertex and
///                     itself, a face of less than three vertices, a coordinate beyond
///                     `verify::kMaxCoordinate_mm`
[[nodiscard]] Result<verify::FoldModel> pattern_model(const Pattern& pattern,
                                                      std::span<const double> psi_rad);

}  // namespace popcut::judge

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/parts/structure.hpp"
#include "core/result.hpp"

namespace popcut {

/// A card of several parts as FOLD 1.2: a frame for each part, flat, with its name as title and the
/// fold angles of one opened pose; `popcut:joints` lists what holds the parts together
/// (docs/parts.md). Numbers read back as the same doubles.
///
/// @param pose_rad  opening of the pages in that pose, between 0 and pi; none: half open
/// @retval Infeasible  a part cannot be there at that opening
[[nodiscard]] Result<std::string> structure_fold(const Structure& card, const std::string& creator,
                                                 std::optional<double> pose_rad = {});

}  // namespace popcut

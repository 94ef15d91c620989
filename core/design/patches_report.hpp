// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/design/design.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/strips/pattern_join.hpp"

namespace popcut {

/// The report of patches in one sheet: slices, merged places, bridges and notes of all of them in
/// the numbering of the whole, errors of all together, counts of the joined pattern. Freedoms and
/// pieces are left to the caller.
///
/// @param bridges  those between patches
[[nodiscard]] DesignReport joined_report(std::span<const Design> patches,
                                         const JoinedStrips& joined,
                                         const std::vector<BridgeReport>& bridges,
                                         const Pattern& pattern);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/design/design.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/strips/pattern_join.hpp"

namespace popcut {

/// Counts and measures a pattern's faces, folds, cuts and sheet for its report.
void count_pattern(const Pattern& pattern, DesignReport& report);

/// How far the structure sticks out of the shut card, with a note, or with a warning where the spec
/// wants it inside. A pattern without a card has nothing to stick out of.
void add_closing(const Pattern& pattern, CardShut asked, DesignReport& report);

/// Where on the sheet the middle of each slice's own strips lies, mm along v.
[[nodiscard]] std::vector<double> slice_places(const Strips& strips, std::size_t slices);

/// Sums the fits of the report's slices, and adds notes where something of the target is out of
/// reach or chains have several minima.
void add_fit(DesignReport& report, FitMode mode);

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

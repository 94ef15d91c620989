// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/design/design.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/strips/pattern_join.hpp"

namespace popcut {

/// Counts and measures a pattern's faces, folds, cuts and sheet for its report.
void count_pattern(const Pattern& pattern, DesignReport& report);

/// What it takes to fold the pattern, and how firmly it holds in paper, with a warning that names
/// the panels that move by more than `hands::kFirm_mm`.
void add_hands(const Pattern& pattern, DesignReport& report);
/// The same for a draft, without how far panels move.
void add_hands_of_draft(const Pattern& pattern, DesignReport& report);

/// How far the structure sticks out of the shut card, with a note, or with a warning where the spec
/// wants it inside. A pattern without a card has nothing to stick out of.
void add_closing(const Pattern& pattern, CardShut asked, DesignReport& report);

/// Says that a step is longer than max_step_over_mean asks for: where, and what it takes.
[[nodiscard]] std::string long_step_warning(const DesignReport& report, double most_over_mean);

/// How far the shut target reaches from the spine, the largest x + z of its sections, mm.
[[nodiscard]] double shut_reach_mm(std::span<const SliceCurve> target);

/// Says where a given card held the planes back: the target reaches farther from the spine, shut,
/// than the card's smaller measure less its margin.
///
/// @return one sentence, empty where the card has room for the target
[[nodiscard]] std::string flattened_by_card(std::span<const SliceCurve> target, double side_mm,
                                            double margin_mm);

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

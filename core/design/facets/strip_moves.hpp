// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/design/facets/label_card.hpp"

namespace popcut {

// What can be done to a card so that more of it is held. None of these functions changes the card:
// they give new labels, of strip `s` where only one strip gets them. Runs are numbered by strip.

/// Run `a` of a strip meets run `b` in a fold, and the runs between them are gone. None if the two
/// do not meet between their own ends, or too little of one is left.
[[nodiscard]] std::optional<std::vector<Label>> with_meeting(const LabelCard& card, int s,
                                                             std::size_t a, std::size_t b);

/// Where run `r` begins with a cut: a panel that meets run `r` and the run before it in folds. At
/// most two such ledges, one before the cut and one after it.
[[nodiscard]] std::vector<std::vector<Label>> with_ledges(const LabelCard& card, int s,
                                                          std::size_t r);

/// Run `r` in the nearest planes beside its own, at most two on each side, with its folds; in
/// paper, in at most two more that lie so far away that their folds count as another place. The
/// panels that it meets go on in the strips beside it, so that they meet planes at two places. That
/// holds them, as in a lattice.
[[nodiscard]] std::vector<std::vector<Label>> shifted(const LabelCard& card, int s, std::size_t r);

/// The strips of a patch with other labels in its place: those of the runs before and after it, up
/// to where these meet if that is inside of it, or those of a strip beside it. Whichever costs
/// least.
///
/// @param take_beside  labels of the strips beside it are tried too
[[nodiscard]] NewStrips painted_over(LabelCard& card, const LoosePatch& patch, bool take_beside);

/// The strips of a patch, solved again without its label there, each beside the new ones before it.
///
/// @param jumps  strips may be cut across
[[nodiscard]] NewStrips without_patch(LabelCard& card, const LoosePatch& patch, bool jumps);

/// Whether all runs of a strip are long enough.
[[nodiscard]] bool is_wide(const std::vector<Label>& labels, int least_run);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/facets/label_pattern.hpp"
#include "core/design/facets/labelling.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// A strip whose labels were changed so that it holds others: without it the card moves in more
/// ways than one.
struct FacetStrut {
  int strip{};
  std::vector<Label> without;  ///< its labels if it did not hold anything
};

/// What repairing did.
struct FacetRepair {
  int loose_before{};  ///< freedoms of the labels as they came, beyond the one
  int shifted{};       ///< panels that went to a plane beside their own in one strip
  int dropped{};       ///< patches that were given up
  std::vector<FacetStrut> struts;
  std::size_t bridges{};  ///< strips that hold what wall or ground would enclose otherwise
  std::size_t inner{};    ///< strips that hold what other paper would enclose otherwise
  bool unfinished{};      ///< it took too long: something is still loose
};

/// How long repairing may take, in panels of strips that are looked at: some seconds. Cards of a
/// hand's size take a tenth of it.
inline constexpr std::size_t kMostRepairWork = 60'000'000;

/// How labels are repaired.
struct RepairOptions {
  bool jumps{};   ///< strips may be cut across
  bool rough{};   ///< fewer moves are tried, and nothing is improved at the end
  bool shifts{};  ///< panels may go to planes beside their own, so that they hold as a lattice does
  /// After which loose patches are only given up; after twice as much it stops, `unfinished`.
  std::size_t most_work{kMostRepairWork};
};

/// Changes labels until the card has exactly one freedom and is one piece, by the moves that cost
/// least of: two panels of a strip are left out, so that those before and after them meet in a
/// fold (a strut); a strip does without cuts across it (a strut); a panel of one strip goes to a
/// plane beside its own, with its folds (a shift): what it meets goes on in the strips beside it,
/// and so meets planes at two places; a loose patch gives its label up. `rigid::mobility` then checks the
/// result. The repair always ends: at worst with the bare card, which has one freedom.
///
/// Patches that others enclose on all sides touch one plane only and so never hold: they are filled
/// at the beginning, or stay, loose until something holds them, where that costs far less.
///
/// @retval Internal  no pattern comes of the labels (a fault of the labels)
[[nodiscard]] Result<FacetRepair> repair(Labelling& labelling, const FacetCardSize& card,
                                         double min_panel_mm, const RepairOptions& how,
                                         const Progress& progress = {});

}  // namespace popcut

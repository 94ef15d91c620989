// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/facets/label_holding.hpp"
#include "core/design/facets/labelling.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// A strip whose labels were changed so that it holds others. Without it the card would move in
/// more than one way.
struct FacetStrut {
  int strip{};
  std::vector<Label> without;  ///< its labels before
};

/// What repairing did.
struct FacetRepair {
  int loose_before{};  ///< freedoms of the labels as they came, beyond the one
  int shifted{};       ///< panels of one strip that moved to a plane beside their own
  int dropped{};       ///< patches that were given up
  std::vector<FacetStrut> struts;
  std::size_t bridges{};  ///< strips without which wall or ground would enclose something
  std::size_t inner{};    ///< strips without which other paper would enclose something
  bool unfinished{};      ///< it took too long, and something is still loose
};

/// How much work a repair may take: the number of panels of strips that it looks at. This is some
/// seconds; a card of a hand's size takes a tenth of it.
inline constexpr std::size_t kMostRepairWork = 60'000'000;

/// How labels are repaired.
struct RepairOptions {
  bool jumps{};   ///< strips may be cut across
  bool rough{};   ///< fewer moves are tried, and nothing is improved at the end
  bool shifts{};  ///< panels may go to planes beside their own, so that they hold as a lattice does
  /// After this much work, loose patches are only given up. After twice as much the repair stops,
  /// `unfinished`.
  std::size_t most_work{kMostRepairWork};
};

/// Changes labels until the card has exactly one freedom and is one piece. Each round makes the
/// moves that cost least for what they hold (strip_moves.hpp):
///
///     strut  a strip loses one or two panels, and the panels before and after them meet in a fold;
///            or a panel fills a cut across a strip; or a strip is solved again without such cuts
///     shift  a panel of one strip goes to a plane beside its own, with its folds
///     drop   a loose patch gets other labels
///
/// Where no move holds enough, the smallest loose patch is given up. The repair always ends: at
/// worst with the bare card, which has one freedom. `rigid::mobility` then checks the result.
///
/// A patch that another one encloses on all sides meets one plane only, so nothing holds it. It is
/// filled before the first round. It stays if a strut for it costs far less than to lose it; then
/// it is loose until a move holds it.
///
/// @retval Internal  the labels do not make a pattern (a fault of the labels)
[[nodiscard]] Result<FacetRepair> repair(Labelling& labelling, const FacetCardSize& size,
                                         const HoldRule& rule, const RepairOptions& how,
                                         const Progress& progress = {});

/// Keeps of the struts those without which the card of `image` would be loose. Those without which
/// something would fall out are counted as `bridges` or `inner` instead. To be called with the
/// final labels: panels that move after the repair may hold what a strut held.
void keep_real_struts(const LabelImage& image, const FacetPlanes& planes, const FacetCardSize& size,
                      double min_panel_mm, FacetRepair& out);

}  // namespace popcut

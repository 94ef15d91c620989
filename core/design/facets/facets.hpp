// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/design/facets/facet_repair.hpp"
#include "core/design/facets/label_pattern.hpp"
#include "core/design/facets/labelling.hpp"
#include "core/design/facets/roofs.hpp"
#include "core/design/spec/report.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// How a card of facets is made.
struct FacetOptions {
  double pitch_mm{2.0};  ///< between the planes that are tried
  double strip_mm{2.0};  ///< width of a strip
  double min_panel_mm{0.5};
  double margin_mm{15.0};
  double from_mm{}, to_mm{};  ///< the stretch of the target along the spine
  std::optional<double> wall_mm, ground_mm;
  bool shut_inside{true};  ///< the shut structure lies inside the card
  bool inward{};           ///< planes behind wall and ground may be taken
  bool kites{};            ///< sloped planes become kites, where they can (roofs.hpp)
  bool tents{};            ///< they become glued roofs, where they can
  double most_roof_play_mm{std::numeric_limits<double>::infinity()};  ///< of a glued roof
  bool lattice{true};   ///< curved parts hold as a lattice does, in planes that are fitted to them
  bool in_paper{true};  ///< panels hold at places that are far enough apart (`paper_rule`)
  int layers{};  ///< upright planes of a silhouette (silhouette.hpp); 0: facets in all planes
  double min_fold_mm{6.0};  ///< of a silhouette: no strut is narrower
  double widen_to_mm{};     ///< of facets: shorter folds are made longer, where that can be
  /// Fewer sweeps and repairs, and no strips that are cut across. Layers of a silhouette need not
  /// hold: they tell only about how large the card becomes.
  bool rough{};
  FacetWeights weights;
};

/// A card of facets.
struct FacetCard {
  FacetGrid grid;
  FacetPlanes planes;
  LabelImage labels;
  FacetCardSize card;
  LabelPattern pattern;
  FacetRepair repaired;
  std::size_t moves{};  ///< of patches and strips, once everything held (`move_patches`)
  FacetFigures figures;
  std::vector<RefusedRoof> refused{};  ///< sloped planes that are neither kites nor tents
  std::vector<TentRun> tents{};        ///< roofs to be glued on
  std::size_t windows{};               ///< cut out, where a patch would hide what is farther back
};

/// Whether anything of a card stands up.
[[nodiscard]] bool stands(const FacetCard& card);

/// A target as origamic architecture: each point of the sheet gets one plane, parallel to the wall
/// or to the ground. With `in_paper` it is made again with a stronger rule where a panel still
/// moves by more than `hands::kFirm_mm`; the firmer one is taken. Where nothing would hold in
/// paper, all is made as exact geometry holds it. What is reported has exactly one freedom
/// (`rigid::mobility`) and is one piece.
///
/// @retval OutOfRange  the card that was asked for is too small, or there are too many cells; place
///                     names the field
/// @retval Infeasible  nothing of the target stands in the corner; with `kites` or `tents`, no
///                     sloped plane can be one
[[nodiscard]] Result<FacetCard> facet_card(const TriangleSoup& target, const FacetOptions& options,
                                           const Progress& progress = {});

}  // namespace popcut

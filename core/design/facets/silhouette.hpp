// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "core/design/facets/label_holding.hpp"
#include "core/design/facets/labelling.hpp"
#include "core/progress.hpp"

namespace popcut {

/// How a target becomes a few upright layers with its outline.
struct SilhouetteOptions {
  int layers{};           ///< upright planes, at least 1
  double min_fold_mm{};   ///< no strut is narrower, and no layer stands on less
  double min_area_mm2{};  ///< smaller pieces of a layer are left out
  bool hold{true};  ///< else layers stay as they are, which tells about how large the card becomes
};

/// Planes of a silhouette: the `layers` upright ones that lie nearest to what is seen (k-medians,
/// exactly, over the distances from the wall), and the level ones of every step, for struts.
/// O(layers x steps^2 + points).
[[nodiscard]] FacetPlanes silhouette_planes(const SeenTarget& target, const FacetGrid& grid,
                                            int layers, int most_x, int most_z);

/// What became of a silhouette's layers.
struct Silhouette {
  std::size_t struts{};   ///< strips of paper that hold a layer from behind
  std::size_t dropped{};  ///< pieces that were left out: too small, or nothing holds them
};

/// Gives each point of the sheet the layer that is nearest to what is seen there, or the card where
/// nothing is; then holds each layer by its foot and by the struts that hide least of it. Cuts are
/// free, folds are few: a layer takes one fold a foot and two a strut.
///
/// @param labelling  of `silhouette_planes`, for `target`
/// @param rule       what holds; its `min_fold_mm` is raised to that of `how`
[[nodiscard]] Silhouette make_silhouette(Labelling& labelling, const SeenTarget& target,
                                         const SilhouetteOptions& how, HoldRule rule,
                                         const Progress& progress = {});

}  // namespace popcut

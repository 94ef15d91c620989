// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/layers/layer_masks.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/vec.hpp"
#include "core/hands/folding.hpp"
#include "core/parts/structure.hpp"
#include "core/pattern/pattern.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

/// A layer of a card, the foremost first.
struct CardLayer {
  double depth_mm{};  ///< behind the foremost point of the target
  double at_mm{};     ///< its apex on the spine
  double height_mm{}, width_mm{};
  LayerChanges changes;
};

/// A target as layers that stand up as a card opens (docs/parts.md). Its parts are the pages, the
/// layers, then struts.
struct LayeredCard {
  Structure card;
  std::vector<CardLayer> layers;
  bool opens_flat{true};  ///< else to 90 degrees: layers stand on one page, parallel to the other
  bool looks_along_spine{};  ///< the front is at v = 0; else at the other end of the spine
  TriangleSoup target;  ///< as it stands on the card: u across the pages, v along the spine, z up;
                        ///< on a card that opens to 90 degrees as `open_pose`
  /// How a point of the surface comes there: placed in the corner, moved by -`origin`, and turned
  /// so that its x axis lies against the way into the picture, which begins at `begin_mm` of the
  /// spine.
  TargetPlacement placement;
  Vec3 origin{0.0, 0.0, 0.0};
  double begin_mm{};
  LayerLook look;  ///< along which the target is drawn on the layers
  std::size_t folds{}, tabs{};
  hands::Handwork handwork;
  std::vector<Warning> warnings;
};

/// Makes the layers of a target, whose x axis points to the front. It stands on the pages, its
/// middle over the spine; each layer is a V-fold across the spine, all with the same angles, so
/// that they never meet. On a card that opens to 90 degrees layers are parallel to the wall
/// (`add_corner_layers`).
///
/// @retval Malformed, OutOfRange  the surface cannot be read
/// @retval Infeasible  it is too small, or a given page is: with the least that holds the layers
[[nodiscard]] Result<LayeredCard> layered_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                               const Progress& progress = {});

/// All faces on the open card: z up; x to the right of who looks at the front, and y away from
/// him, or both opposite (`looks_along_spine`).
[[nodiscard]] PartPoses open_pose(const LayeredCard& made);
/// The same at another opening of the pages. The page that layers stand on stays level if they
/// stand on one only; else both slope alike.
[[nodiscard]] PartPoses pose_at(const LayeredCard& made, double opening_rad);

/// Moves points of a target (x, y, z one after the other, x to the front, mm, already less the
/// card's `origin`) to their places on the card.
void move_to_card(const LayeredCard& made, std::vector<double>& corners);

/// The lines of each part, to draw and to cut: `Pattern`s of lines only. Mountains and valleys are
/// those of a half-open card.
[[nodiscard]] std::vector<Pattern> part_drawings(const Structure& card);
/// The same of all parts side by side.
[[nodiscard]] Pattern parts_drawing(const Structure& card);

/// What a person has to do for a card of parts: all its folds, waste and tabs.
struct PartsWork {
  std::size_t folds{}, tabs{};
  hands::Handwork handwork;
};
[[nodiscard]] PartsWork parts_work(const Structure& card);

/// All faces in a pose as triangles.
[[nodiscard]] TriangleSoup faces_in_space(const Structure& card, const PartPoses& pose);

}  // namespace popcut

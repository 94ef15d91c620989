// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/design/layers/layer_masks.hpp"
#include "core/geometry/vec.hpp"
#include "core/parts/structure.hpp"

namespace popcut {

/// A level strip of paper behind a layer, which holds it at its distance from what is behind it:
/// from `from_mm` to `to_mm` to the right of the middle, at `height_mm`.
struct LayerStrut {
  double from_mm{}, to_mm{};
  double height_mm{};
};

/// A layer that stands parallel to the wall of a card that opens to 90 degrees.
struct CornerLayer {
  std::string name;
  /// Its paper: to the right of the middle, and up; faces touch where holes part them.
  std::vector<std::vector<Vec2>> outlines;
  double foot_from_mm{}, foot_to_mm{};  ///< its border on the ground
  double out_mm{};                      ///< from the wall
  LayerStrut strut;                     ///< to the next layer, or to the wall
};

/// Where a strut of `deep_mm` tabs fits behind a layer and cannot be seen: on paper of the layer,
/// `margin_mm` within it. The wider and higher one, at most `most_mm` wide; none if no place has
/// `least_mm`.
[[nodiscard]] std::optional<LayerStrut> strut_behind(const LayerGrid& grid, const LayerMask& mask,
                                                     double least_mm, double most_mm,
                                                     double deep_mm, double margin_mm);

/// Lays paper where the tab of a strut is glued, and `margin_mm` around it.
void add_strut_paper(const LayerGrid& grid, const LayerStrut& strut, double deep_mm,
                     double margin_mm, LayerMask& mask);

/// Adds layers, the foremost first, and their struts behind all of them. Each layer, its strut, the
/// ground and what is behind it are a parallelogram, so that all layers stay parallel to the wall
/// while the card opens. In a frame of the ground `g` and the wall `w`, both square to the spine,
/// a place of a layer at `x` that is `h` high is `x g + h w`.
void add_corner_layers(Structure& card, const std::vector<CornerLayer>& layers);

}  // namespace popcut

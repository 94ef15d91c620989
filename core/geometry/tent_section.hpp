// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

namespace popcut {

/// A glued roof of a card that opens to 90 degrees, seen along the spine (docs/facets.md, "Glued
/// roofs"). A level panel goes from its fold F on an upright panel to the eave A. The roof is
/// hinged at A. A strut is hinged on the roof at Q, and on the upright panel at B.
///
/// F-A-Q-B is a four-bar linkage. It shuts flat if foot + strut_at = strut_foot + strut: A, Q and B
/// then lie on one line from F, Q farthest out.
///
/// Its tabs go where they are turned least from what they hang on: below A on the front, from Q
/// towards A, and above B. So folds that are off their lines move the roof least.
struct TentSection {
  double foot_mm{};        ///< from F to A
  double roof_mm{};        ///< from A to the ridge
  double slope_rad{};      ///< of the roof at 90 degrees
  double strut_at_mm{};    ///< from A to Q
  double strut_foot_mm{};  ///< from F to B
  double strut_mm{};       ///< from B to Q

  /// Where the roof points at an opening, from the direction of the level panel towards the upright
  /// one: pi - `slope_rad` at 90 degrees, 0 shut. NaN where the strut is too short.
  [[nodiscard]] double roof_rad(double psi_rad) const;
  /// How far the ridge moves at 90 degrees where all three folds are `off_mm` off their lines
  /// (rms), as `verify` counts it, while the sheet stays.
  [[nodiscard]] double play_mm(double off_mm) const;
  /// The least distance of the ridge from the upright panel over all openings, over the sine of the
  /// opening: it vanishes as the card shuts. Below 0: the roof passes through that panel. NaN: the
  /// linkage does not reach all openings.
  [[nodiscard]] double clearance_mm() const;
};

/// A tent whose strut begins at `strut_at_mm`. Its foot on the upright panel follows from the rule
/// for shutting: with d = foot, q = strut_at and t = slope, d q (1 + cos t) / (d + q (1 - sin t)).
[[nodiscard]] TentSection tent_at(double foot_mm, double roof_mm, double slope_rad,
                                  double strut_at_mm);

/// The tent with the least play whose strut is hidden by the roof: its foot is no higher than the
/// ridge. None: each passes through the upright panel.
[[nodiscard]] std::optional<TentSection> firmest_tent(double foot_mm, double roof_mm,
                                                      double slope_rad);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

namespace popcut {

/// A point of a section across the spine, mm: distance from the wall and height above the ground in
/// the pose psi = pi/2 of a stair; in space where a function says so.
struct KitePoint {
  double x{}, z{};
};

/// Two sloped panels of one sheet, seen along the spine: from Q on a level panel to E on an upright
/// one by a fold at R (docs/facets.md, "Sloped panels").
///
/// A stair goes from Q down to S' = (Q.x, E.z) and on to E. A kite is the same paper on the other
/// side: at every opening each of its points is the stair's, mirrored in the line from Q to E. Flat
/// and shut the two are one. With p = E.x - Q.x and q = Q.z - E.z, both above 0, the panel RE is p
/// long and falls at theta = 2 atan(q / p) at psi = pi/2; QR is q long and square to it.
///
/// - Type I, q < p: RE is a roof that is hinged at its eave E. Shut, R lies 2 p q / (p - q) behind
/// Q.
/// - Type II, q > p: QR is a roof that is hinged at its ridge Q and falls at theta - 90 degrees; RE
///   is the soffit below its eave. R comes down 2 p q / (q - p) below E.
struct KiteSection {
  KitePoint q, e;

  [[nodiscard]] double p_mm() const { return e.x - q.x; }
  [[nodiscard]] double q_mm() const { return q.z - e.z; }
  /// Whether it is of type II.
  [[nodiscard]] bool overhangs() const { return q_mm() > p_mm(); }
  /// How steep its roof falls at psi = pi/2.
  [[nodiscard]] double slope_rad() const;
  /// Whether a point of the stair lies on the kite's panels, not on its folds Q and E.
  [[nodiscard]] bool has(double x, double z) const;

  /// Where the stair's point (x, z) lies in space at `psi_rad`. O(1), for all of 0 .. pi.
  [[nodiscard]] KitePoint posed(double x, double z, double psi_rad) const;
  /// How far towards the eye the kite lies where it is looked at along (1, 0, 1) at psi = pi/2: x +
  /// z of what is seen of it at x - z = `across_mm`. NaN where nothing of it is.
  [[nodiscard]] double depth_mm(double across_mm) const;
  /// The fold at psi = pi/2.
  [[nodiscard]] KitePoint r() const;
  /// How far the folds at Q and at E are bent: pi - psi less twice the angle at the short panel.
  /// One is a valley and the other a mountain: Q is the valley of type I. The fold at R is a
  /// mountain, bent by pi - psi.
  [[nodiscard]] double bend_rad(double psi_rad) const;

  /// How far from an upright panel behind Q (type I), or above a level panel below E (type II), the
  /// kite must hang so that it never crosses it: at every opening if and only if it is so far.
  [[nodiscard]] double clearance_mm() const;
  /// Whether it crosses neither the wall nor the ground at any opening.
  [[nodiscard]] bool clears_card(double slack_mm = 0.0) const {
    return (overhangs() ? e.z : q.x) >= clearance_mm() - slack_mm;
  }
};

/// The kite of type I whose roof falls at `slope_rad` over `length_mm` down to its eave.
[[nodiscard]] KiteSection kite_at_eave(const KitePoint& eave, double slope_rad, double length_mm);
/// The kite of type II whose roof falls at `slope_rad` over `length_mm` from its ridge.
[[nodiscard]] KiteSection kite_at_ridge(const KitePoint& ridge, double slope_rad, double length_mm);

/// How long a roof of type I can be whose eave is `eave_x_mm` from the wall.
[[nodiscard]] double longest_at_eave_mm(double eave_x_mm, double slope_rad);
/// How long a roof of type II can be whose ridge is `ridge_z_mm` above the ground.
[[nodiscard]] double longest_at_ridge_mm(double ridge_z_mm, double slope_rad);

}  // namespace popcut

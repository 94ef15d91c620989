// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/design/target/curve.hpp"

namespace popcut {

/// Distance of points from one section of the target, many times over: closed form for a circle,
/// else the foot of the perpendicular by Newton on a table of the curve (cubic between 257 places
/// of its chord parameter). Beyond wall and ground the curve goes straight on.
class SectionDistance {
 public:
  SectionDistance() = default;
  explicit SectionDistance(const SliceCurve& curve);

  /// Signed distance, positive outside, mm; its gradient, a unit vector; and the chord parameter of
  /// the foot (`SliceCurve`).
  struct Foot {
    double e{}, ex{}, ez{}, t{};
  };
  [[nodiscard]] Foot foot(SectionPoint p) const;
  /// The curve's point of chord parameter `t`.
  [[nodiscard]] SectionPoint at(double t) const;

 private:
  struct Rise {
    double n{}, dn{}, ddn{};
  };
  [[nodiscard]] Rise rise(double t) const;

  double h_{}, d_{};
  bool circle_{};
  std::vector<double> n_, dn_;  ///< over the table's places
};

}  // namespace popcut

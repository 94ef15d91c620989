// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/design/lattice/lattice.hpp"
#include "core/design/lattice/section_distance.hpp"

namespace popcut {

/// A plane of a lattice that a panel uses: an unknown, or a constant (`index` -1).
struct PlaneRef {
  int index{-1};
  double constant{};

  [[nodiscard]] double of(const std::vector<double>& p) const {
    return index < 0 ? constant : p[static_cast<std::size_t>(index)];
  }
};

/// A panel of a strip: it lies in `plane` and reaches from `begin` to `end` along the other axis.
struct Panel {
  PlaneRef begin, end, plane;
  int strip{};
  bool level{};  ///< parallel to the ground: `plane` is a height, the others are offsets
};

/// The squared distance of panels from the target, and how it changes with their planes:
///
///     E = sum over strips w sum over panels integral of e^2 q ds,     q = 1 / (1 + e_v^2),
///
/// `e` the distance from the strip's section, `e_v` its change along the spine, so that `e^2 q` is
/// to first order the squared distance in space: (rho - r)^2 / (1 + r'^2) for a revolution. Each
/// panel is integrated by Gauss's three points; the derivatives are those of that sum.
class PanelError {
 public:
  explicit PanelError(const RunTarget& target);

  /// Strips in the order of the sheet: slice 0, connector 0, slice 1, ...
  [[nodiscard]] int strips() const { return static_cast<int>(section_.size()); }
  [[nodiscard]] double width(int strip) const { return width_[static_cast<std::size_t>(strip)]; }
  [[nodiscard]] const SectionDistance& section(int strip) const {
    return section_[static_cast<std::size_t>(strip)];
  }
  /// q of the strip at the chord parameter `t`.
  [[nodiscard]] double steepness(int strip, double t) const;

  [[nodiscard]] double value(const Panel& panel, const std::vector<double>& p) const;
  /// With derivatives by begin, end and plane. The second ones are those of a target without
  /// curvature.
  struct Jet {
    double value{};
    std::array<double, 3> first{};
    std::array<double, 6> second{};  ///< bb, be, bp, ee, ep, pp
  };
  [[nodiscard]] Jet jet(const Panel& panel, const std::vector<double>& p) const;

 private:
  static constexpr int kSteepPlaces = 33;
  std::vector<SectionDistance> section_;
  std::vector<double> width_;
  std::vector<double> steep_;  ///< kSteepPlaces a strip
};

}  // namespace popcut

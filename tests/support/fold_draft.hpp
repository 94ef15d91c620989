// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace popcut::testing {

/// A FOLD file before it is text, for tests that build a pattern by hand and then break it.
struct FoldDraft {
  struct Pose {
    double psi_rad{};
    std::vector<std::array<double, 3>> at;  ///< (x, v, z)
    std::vector<double> angle_deg;          ///< one an edge
  };
  std::vector<std::array<double, 2>> flat;  ///< (u, v)
  std::vector<std::array<std::size_t, 2>> edges;
  std::string assignment;                       ///< a letter an edge
  std::vector<double> key_angle_deg;            ///< empty: the member is left out
  std::vector<std::vector<std::size_t>> faces;  ///< likewise
  std::vector<Pose> poses;

  [[nodiscard]] std::string text() const;
};

/// A strip of a card: a staircase from the wall to the ground. Panel k lies in plane `plane[k]` and
/// runs from `points[k]` to `points[k + 1]`, as (X, Z); neighbours with the same plane are joined.
struct DraftStrip {
  double width_mm{};
  std::vector<std::pair<double, double>> points;
  std::vector<int> plane;
};

/// Builds the split-form pattern of a row of strips on a sheet with wall height `wall_mm`, with
/// poses at pi, pi/2 and 1.1 rad. Every panel of a strip is a face; joined ones meet in an F edge.
/// It shares nothing with popcut's own generator: every panel, vertex and cut comes from comparing
/// neighbouring strips' planes interval by interval.
[[nodiscard]] FoldDraft draft_of(const std::vector<DraftStrip>& strips, double wall_mm);

/// The lattice of a quarter cylinder: `levels` units on `slices` slices of the given width.
/// With the card it has one freedom.
struct CylinderCard {
  int levels{3};
  int slices{2};
  double radius_mm{30.0};
  double width_mm{10.0};
  double margin_mm{15.0};
  bool card{true};
};
[[nodiscard]] std::vector<DraftStrip> strips_of(const CylinderCard& cylinder);
[[nodiscard]] FoldDraft draft_of(const CylinderCard& cylinder);

/// One box on a card: wall, ground and two panels.
[[nodiscard]] FoldDraft box_card();

}  // namespace popcut::testing

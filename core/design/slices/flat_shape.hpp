// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "core/design/slices/plane_section.hpp"
#include "core/geometry/interval_bins.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {

// Flat paper: rings, outlines counter-clockwise and holes clockwise, that do not cross. All places
// are multiples of `kShapeStep_mm`, and stay so (Vatti 1992, by the library Clipper).

inline constexpr double kShapeStep_mm = 1e-5;

/// What rings wind around, at least once in either direction.
[[nodiscard]] FlatRings inside_of(const FlatRings& rings);
[[nodiscard]] FlatRings joined(const FlatRings& shape, const FlatRings& with);
[[nodiscard]] FlatRings without(const FlatRings& shape, const FlatRings& cut);
[[nodiscard]] FlatRings common(const FlatRings& shape, const FlatRings& with);

/// mm^2, holes taken away.
[[nodiscard]] double area_of(const FlatRings& shape);

/// The upright rectangle between two corners.
[[nodiscard]] std::vector<Vec2> rectangle(Vec2 low, Vec2 high);

/// A shape without the points from which it strays by at most `off_mm` without them (Douglas and
/// Peucker 1973). What then crosses itself is made simple.
[[nodiscard]] FlatRings with_fewer_points(const FlatRings& shape, double off_mm);

/// Connected paper: its outline first, then its holes.
[[nodiscard]] std::vector<FlatRings> pieces_of(const FlatRings& shape);

/// Connected paper of a shape after cuts, with rings that do not touch (`without_touching`).
[[nodiscard]] std::vector<FlatRings> pieces_without(const FlatRings& shape, const FlatRings& cuts);

/// A shape whose rings do not touch: where they do, a square of 0.1 mm is cut away, so that a hole
/// that touches the outline is open there.
[[nodiscard]] FlatRings without_touching(const FlatRings& shape);

/// A stretch of a line with paper on it.
struct PaperSpan {
  double from{}, to{};
  [[nodiscard]] double length() const { return to - from; }
};
/// Where the upright line at `u_mm` has paper, ascending.
[[nodiscard]] std::vector<PaperSpan> paper_at(const FlatRings& shape, double u_mm);

/// A shape, asked for its paper on many upright lines: its sides in bins.
class UprightLines {
 public:
  explicit UprightLines(const FlatRings& shape);

  /// Whether the line at `u_mm` meets the shape's box.
  [[nodiscard]] bool reaches(double u_mm) const { return u_mm > low_ && u_mm < high_; }
  /// As `paper_at` of the shape.
  [[nodiscard]] std::vector<PaperSpan> paper_at(double u_mm) const;
  /// Where the line passes sides, in no order.
  [[nodiscard]] std::vector<double> passages_at(double u_mm) const;

 private:
  struct Side {
    Vec2 from, to;
  };
  double low_{}, high_{};
  std::vector<Side> sides_;
  IntervalBins bins_;
};

[[nodiscard]] Eigen::AlignedBox2d box_of(const std::vector<Vec2>& ring);

/// Polygons without holes that make up a piece. They touch along upright lines through its holes,
/// and share the corners there.
[[nodiscard]] FlatRings faces_of_piece(const FlatRings& piece);

/// What a shape sweeps as it comes straight down from `height_mm` above its place.
[[nodiscard]] FlatRings swept_from_above(const FlatRings& shape, double height_mm);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/page_point.hpp"

namespace popcut {

/// Polylines one after the other. A closed one repeats its first point.
struct Polylines {
  std::vector<PagePoint> points;
  std::vector<std::uint32_t> ends;  ///< per line: one past its last point

  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] std::span<const PagePoint> operator[](std::size_t i) const {
    const std::size_t from = i == 0 ? 0 : ends[i - 1];
    return std::span(points).subspan(from, ends[i] - from);
  }
  void clear() {
    points.clear();
    ends.clear();
  }
};

/// What a stroke is for, in cutting order. The sheet's own outline comes last, because no part of
/// the sheet may move before it is cut (docs/geometry.md, section 8).
enum class Operation : std::uint8_t { Draw, Score, FoldMountain, FoldValley, Cut, Outline };

/// An operation, and the pen that does it: 0 is the material's own settings, others count the pens
/// that a person gave for a colour or a layer. Lines of two pens are never joined.
struct PenOperation {
  Operation operation{};
  std::uint8_t pen{};

  constexpr PenOperation() = default;
  // NOLINTBEGIN(google-explicit-constructor): who knows nothing of pens sees an operation
  constexpr PenOperation(Operation what, std::uint8_t with = 0) : operation(what), pen(with) {}
  constexpr operator Operation() const { return operation; }
  // NOLINTEND(google-explicit-constructor)
  friend constexpr auto operator<=>(const PenOperation&, const PenOperation&) = default;
  friend constexpr bool operator==(const PenOperation&, const PenOperation&) = default;
  friend constexpr bool operator==(const PenOperation& a, Operation b) { return a.operation == b; }
};

inline constexpr std::size_t kMostPens = 64;  ///< that a person gives by colour or layer

/// One path with the tool down: points `first .. first + count` of its `Toolpath`.
struct Stroke {
  Operation operation{};
  std::uint32_t first{};
  std::uint32_t count{};   ///< at least 2; a closed stroke repeats its first point at the end
  std::uint32_t line{};    ///< the line of the drawing that it came from
  std::uint8_t tool{1};    ///< tool holder, from 1
  std::uint8_t pen{};      ///< see `PenOperation`
  std::uint8_t rounds{1};  ///< of a closed line, without lifting
  double force_gf{};
  double speed_mm_s{};
};

/// Ordered strokes for one sheet, with all points in one array.
struct Toolpath {
  std::vector<PagePoint> points;
  std::vector<Stroke> strokes;

  [[nodiscard]] std::span<const PagePoint> points_of(const Stroke& stroke) const {
    return std::span(points).subspan(stroke.first, stroke.count);
  }
};

}  // namespace popcut

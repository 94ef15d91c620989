// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"

namespace popcut {

/// Whether `word` is the mat's name, whatever its capitals ("12X12").
[[nodiscard]] bool is_mat_name(const Mat& mat, std::string_view word);

/// Width and length in mm: "300x200", "300x200mm", "12x12in", "30.5x30.5cm".
///
/// @retval Usage  it is none of these, or a side is not between 1 mm and 100 m
[[nodiscard]] Result<std::array<double, 2>> parse_size_mm(std::string_view text);

/// The mat that `wanted` names on `machine`: one of its mats by name, or a size of its own (mat
/// code 0: none is told). Empty: the first of the machine's mats, or its whole area.
///
/// @retval Usage       neither a name nor a size
/// @retval OutOfRange  larger than the machine
[[nodiscard]] Result<Mat> choose_mat(const Machine& machine, std::string_view wanted);

/// An ideal plotter of a size: GPGL in 0.05 mm units, nothing of a real machine in its way.
[[nodiscard]] Result<Machine> ideal_plotter(double width_mm, double length_mm);

/// What of the mat the tool can reach, mm along carriage and feed.
[[nodiscard]] std::array<double, 2> reach_mm(const Machine& machine, const Mat& mat);

/// A rigid move of the page onto the sheet: (x, y) -> (xx x + xy y + x0, yx x + yy y + y0).
struct Placement {
  double xx{1}, xy{0}, x0{0};
  double yx{0}, yy{1}, y0{0};
  [[nodiscard]] PagePoint operator()(const PagePoint& p) const {
    return {xx * p.x + xy * p.y + x0, yx * p.x + yy * p.y + y0};
  }
};

struct PlaceOptions {
  std::optional<PagePoint> at{};  ///< upper left corner of the drawing on the sheet
  bool clip{false};               ///< what lies outside of the area will be cut off
};

/// Where the drawing goes on an area of `reach`. A drawing with a page of its own stays where it is
/// if it lies inside; else it is put with up to 10 mm of margin, turned by 90 degrees only where it
/// fits only so. Never mirrored: the determinant is always +1.
///
/// @retval Infeasible  it does not fit (and is not to be clipped); the detail has both sizes
[[nodiscard]] Result<Placement> place(const LineWork& work, const std::array<double, 2>& reach,
                                      const PlaceOptions& options);

[[nodiscard]] LineWork placed(LineWork work, const Placement& placement);

/// The drawing within [room, width - room] x [room, length - room]: each line is cut exactly at the
/// border, and what is left of it goes on as lines of their own. What runs along the border is
/// inside.
[[nodiscard]] LineWork clipped(const LineWork& work, const std::array<double, 2>& reach,
                               double room = 0.0);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut::calibrate {

/// What `popcut calibrate` cuts. Pages are in mm: x to the right, y down from the upper left
/// corner.

/// Two lines from one corner, at right angles. The one that should run to the right has one tick at
/// its end, the one that should run down has two.
struct Angle {
  PagePoint corner{20, 20};
  double right_mm{}, down_mm{};  ///< lengths of the lines

  [[nodiscard]] Toolpath path(const ToolSettings& tool) const;
};

/// A short angle that lies on the sheet even if the machine exchanges its axes.
[[nodiscard]] Angle short_angle();
/// A long one, to measure with a ruler.
///
/// @param area_mm      of the page: across and along
/// @retval Infeasible  the page is smaller than 80 x 80 mm
[[nodiscard]] Result<Angle> long_angle(std::array<double, 2> area_mm);

/// A square of 20 mm, 10 mm from the page's upper and left edge.
[[nodiscard]] Toolpath corner_square(const ToolSettings& tool);

/// Strokes whose time says something of one part of a machine's motion.
struct TimedRun {
  std::string name;  ///< "long moves"
  Toolpath path;
};

/// Runs that tell the parts of a machine's motion apart; the last one mixes all, to check. Speeds
/// are whole steps of the machine. All lie beside each other on 100 x 170 mm.
///
/// @retval Infeasible  the page is smaller than that
[[nodiscard]] Result<std::vector<TimedRun>> timed_runs(const Machine& machine,
                                                       const ToolSettings& tool,
                                                       std::array<double, 2> area_mm);

/// Eight squares of 8 mm in a row, the first cut with the least force.
struct ForceSteps {
  Toolpath path;
  std::vector<double> force_gf;  ///< of each square
};

/// From 0.5 to 1.6 times the material's force, each a step of the machine apart at least.
///
/// @retval OutOfRange  the machine's force is not set by programs
[[nodiscard]] Result<ForceSteps> force_steps(const Machine& machine, const ToolSettings& tool);

/// One square of 8 mm, the `index`th of a row below those of the forces.
[[nodiscard]] Toolpath depth_square(const ToolSettings& tool, int index);

}  // namespace popcut::calibrate

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "core/drawing/toolpath.hpp"
#include "protocol/encode.hpp"
#include "protocol/page_map.hpp"

namespace popcut {

/// A point on the machine's grid: whole units, or hundredths of them.
struct GridPoint {
  std::int64_t a{};
  std::int64_t b{};
  friend constexpr bool operator==(const GridPoint&, const GridPoint&) = default;
};

/// A stroke's tool with force and speed in the machine's steps. None: it has no such setting.
struct StrokeSteps {
  int tool{1};
  std::optional<std::int64_t> force;
  std::optional<std::int64_t> speed;
};

/// The place of stroke `index` in error messages.
[[nodiscard]] std::string stroke_place(std::size_t index);

/// Steps for the stroke's force and speed, and whether the machine has its holder.
///
/// @retval OutOfRange  names what the machine takes
[[nodiscard]] Result<StrokeSteps> steps_of(const Stroke& stroke, std::size_t index,
                                           const Machine& machine);

/// Puts the stroke's points on the grid in `line` (cleared before), without repeats.
///
/// @param per_unit  grid lines a machine unit: 1, or 100 for two decimals
/// @retval OutOfRange  a coordinate is not finite or further than 2^30 from the origin
/// @retval Internal    the stroke's points are not in the toolpath
[[nodiscard]] Result<void> put_on_grid(const Toolpath& toolpath, std::size_t index,
                                       const PageMap& map, int per_unit,
                                       std::vector<GridPoint>& line);

/// Pen or blade for the holders 1, 2, ... up to the highest that is used.
[[nodiscard]] std::vector<ToolKind> holders_of(const Toolpath& toolpath, const JobOptions& options);

/// Appends `value / per_unit` in decimal: whole numbers plain, others with two decimals.
void append_number(std::string& text, std::int64_t value, int per_unit = 1);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/plan/linework.hpp"
#include "core/plan/machine.hpp"
#include "core/plan/order.hpp"
#include "core/plan/sheet.hpp"

namespace popcut {

struct PlanOptions {
  std::string mat{};  ///< name or size, see `choose_mat`; empty: the machine's own
  PlaceOptions place{};
  OrderOptions order{};  ///< its `cost` is the machine's
};

/// One sheet: what the cutter does, in order, and its figures.
struct PlannedSheet {
  Mat mat;
  std::array<double, 2> area_mm{};  ///< what can be reached, along carriage and feed
  Toolpath path;
  Placement transform;         ///< pattern page -> sheet
  double cut_mm{}, fold_mm{};  ///< tool down, as sent
  double fold_line_mm{};       ///< folds before dashing
  double travel_mm{}, travel_input_mm{}, home_mm{};
  std::uint64_t order_moves{};  ///< that the search for a short way tried
  bool order_finished{true};    ///< false: it was ended early
  std::size_t paths{};  ///< lines of the drawing after cleaning
  double seconds{};
  std::array<double, 2> seconds_range{};
};

struct Plan {
  std::string name;
  Machine machine;
  Material material;
  std::vector<PlannedSheet> sheets;
  std::vector<std::string> warnings;
  std::uint64_t seed{};
};

/// Drawing to ordered strokes: placed on the mat, cleaned, folds dashed, put in order, with force,
/// speed and tool from the material within what the machine can.
///
/// @retval Infeasible  it does not fit; the detail has both sizes in mm
/// @retval OutOfRange  there is nothing to cut, or far too much; the mat is larger than the machine
/// @retval Usage       the mat is not known
[[nodiscard]] Result<Plan> plan(const LineWork& drawing, const Machine& machine,
                                const Material& material, const PlanOptions& options);

}  // namespace popcut

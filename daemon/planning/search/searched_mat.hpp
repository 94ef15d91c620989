// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/plan/plan_options.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// What the cards of a search are cut on.
struct SearchedMat {
  Machine machine;
  std::array<double, 2> area_mm{};  ///< that the tool reaches
  std::array<double, 2> room_mm{};  ///< for a card: the area, or what lies between its marks
};

/// Plans a small test shape, so that options which no card can be planned with are refused before
/// anything is searched. Takes some milliseconds.
///
/// @param options  of which a search has machine, material, mat and marks
/// @param tables   users' tables
/// @retval Usage, OutOfRange, Infeasible  an option is not valid, or popcut knows no cutting times
///                 of the machine; place is `pointer_to` the option
[[nodiscard]] Result<SearchedMat> searched_mat(const PlanOptions& options,
                                               const std::vector<std::string>& tables);

}  // namespace popcut::planning

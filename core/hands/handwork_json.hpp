// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "core/hands/folding.hpp"

namespace popcut::hands {

/// The `handwork` of a report or a plan.
[[nodiscard]] inline nlohmann::ordered_json handwork_json(const Handwork& work) {
  return {{"folds", work.folds},   {"shortest_fold_mm", work.shortest_mm},
          {"waste", work.waste},   {"tabs", work.tabs},
          {"fold_s", work.time_s}, {"label", work.label}};
}

}  // namespace popcut::hands

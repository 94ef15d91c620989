// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

/// What the options about drawings larger than the mat were given as.
struct SplitOption {
  std::vector<double> seams_x, seams_y;
  std::string labels{"auto"};
  bool never{false};
};

/// Adds --seam-x, --seam-y, --labels and --no-split.
void add_split_options(CLI::App& command, SplitOption& option);

/// @retval Usage  a word is not known, a seam is no finite number, or seams without splitting
[[nodiscard]] Result<void> read_split_option(const SplitOption& option, PlanOptions& options);

}  // namespace popcut::cli

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>

#include "core/plan/machine.hpp"
#include "core/plan/marks.hpp"
#include "core/result.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

/// The options about registration marks, shared by `plan` and `cut`.
struct MarkOption {
  bool wanted{false};
  std::string form{"arm"};
};

/// Adds --marks and --mark-form.
void add_mark_options(CLI::App& command, MarkOption& option);

/// The marks of a sheet; none where they are not wanted.
///
/// @retval Usage       the form is not known
/// @retval Infeasible  the sheet is too small
[[nodiscard]] Result<std::optional<MarkLayout>> read_mark_option(const MarkOption& option,
                                                                 const Machine& machine,
                                                                 std::array<double, 2> area_mm);

}  // namespace popcut::cli

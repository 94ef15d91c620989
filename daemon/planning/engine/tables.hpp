// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"

namespace popcut::planning {

/// popcut's own tables as one JSON document, for who does popcutd's part without it: "machines" to
/// choose from (`machine_choice`), and the "rows" of "machines" and "materials" by name, for tasks.
///
/// @retval Malformed  a built-in table is not of its form
[[nodiscard]] Result<std::string> tables_text();

}  // namespace popcut::planning

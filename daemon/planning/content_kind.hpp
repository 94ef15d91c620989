// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "core/result.hpp"
#include "daemon/planning/plan_input.hpp"

namespace popcut::planning {

/// What a file is, by its content alone: JSON with "popcut" is a spec, with "file_spec" or
/// "vertices_coords" a FOLD file, what begins with '<' an SVG, with a group code a DXF.
///
/// @retval Malformed  none of these, or JSON that breaks before its kind is known (line and column)
[[nodiscard]] Result<InputKind> kind_of_content(std::string_view text);

/// "spec", "fold", "svg", "dxf".
[[nodiscard]] std::string_view name_of(InputKind kind);
/// @retval OutOfRange  none of these
[[nodiscard]] Result<InputKind> input_kind_from(std::string_view name);

}  // namespace popcut::planning

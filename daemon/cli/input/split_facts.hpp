// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/layout/piece_lines.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// Reads the pieces that lie on a sheet of a split plan, with their seams and tabs. `sheet` is the
/// sheet's JSON pointer, as in "/sheets/0".
///
/// @retval Malformed  not of a plan's form; place is a JSON pointer
[[nodiscard]] Result<std::vector<PlannedPiece>> read_split_facts(const nlohmann::json& plan,
                                                                 const std::string& sheet);

}  // namespace popcut::cli

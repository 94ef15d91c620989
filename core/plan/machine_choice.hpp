// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "core/machines/machine.hpp"

namespace popcut {

/// What a person chooses a machine and its mat by, as JSON: name and title, whether popcut drives
/// it, its size and mats, and what registration marks take of a sheet, in mm.
[[nodiscard]] nlohmann::ordered_json machine_choice(const Machine& machine);

}  // namespace popcut

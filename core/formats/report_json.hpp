// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/report.hpp"

namespace popcut {

/// The text of `report.json`: the fields of the report by their manual names, each with its unit in
/// its name, in a fixed order. `units_per_slice` is a number, or a list when regions differ; a
/// figure that is not finite is null.
[[nodiscard]] std::string report_json(const DesignReport& report);

}  // namespace popcut

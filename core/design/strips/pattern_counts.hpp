// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/spec/report.hpp"
#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// Counts and measures a pattern's faces, folds, cuts and sheet for its report.
void count_pattern(const Pattern& pattern, DesignReport& report);

/// Where on the sheet the middle of each slice's own strips lies, mm along v.
[[nodiscard]] std::vector<double> slice_places(const Strips& strips, std::size_t slices);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/spec/report.hpp"
#include "core/design/target/surface_spec.hpp"

namespace popcut {

/// Sums the fits of the report's slices, and adds notes where something of the target is out of
/// reach or chains have several minima.
void add_fit(DesignReport& report, FitMode mode);

}  // namespace popcut

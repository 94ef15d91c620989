// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/spec/spec.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// Reads the files that a spec's surface names, relative to the folder of `spec_file`.
///
/// @retval Malformed  a file is absent, unreadable or larger than a gigabyte
[[nodiscard]] Result<SurfaceAssets> load_assets(const DesignSpec& spec,
                                                const std::string& spec_file);

/// Prints the spec with a placement for its mesh or grid (`propose_placement`) on standard output,
/// and what it reaches on standard error. `quarter`: its middle on the spine, else all in the
/// corner.
[[nodiscard]] Result<void> print_placed_spec(const DesignSpec& spec, const std::string& spec_text,
                                             const SurfaceAssets& assets, bool quarter, bool quiet);

}  // namespace popcut::cli

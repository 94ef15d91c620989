// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/compare/picture.hpp"
#include "core/design/spec/spec.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// Reads the files that a spec's surface names, relative to the folder of `spec_file`.
///
/// @retval Malformed  a file is absent, unreadable or larger than a gigabyte
[[nodiscard]] Result<SurfaceAssets> load_assets(const DesignSpec& spec,
                                                const std::string& spec_file);

/// The material that a spec names, of popcut's and the user's tables.
///
/// @retval OutOfRange  there is none of this name; Malformed: the user's tables cannot be read
[[nodiscard]] Result<Material> material_of(const DesignSpec& spec, const std::string& spec_file);

/// The mean colours of the triangles of a spec's model (`mean_colours`); empty: it is clay.
///
/// @param assets     `load_assets`
/// @param triangles  of the model
[[nodiscard]] std::vector<likeness::Rgb> asset_colours(const std::string& spec_file,
                                                       const SurfaceAssets& assets,
                                                       std::size_t triangles);

/// Prints the spec with a placement for its mesh or grid (`propose_placement`) on standard output,
/// and what it reaches on standard error. `quarter`: its middle on the spine, else all in the
/// corner.
[[nodiscard]] Result<void> print_placed_spec(const DesignSpec& spec, const std::string& spec_text,
                                             const SurfaceAssets& assets, bool quarter, bool quiet);

}  // namespace popcut::cli

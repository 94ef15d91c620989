// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/design/patches.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// The name of the file that says what is wrong with a design.
inline constexpr const char* kUnsoundFile = "unsound.json";

/// What the verifier found wrong with a design.
struct Unsound {
  Error error;         ///< Internal, with the first failure
  std::string report;  ///< JSON for `kUnsoundFile`: what and where, part by part
};

/// Has the verifier, which shares no code with the generator, look at each part as it would be
/// written: one piece, sound edges and faces, a tiled sheet, isometric poses, the freedoms that are
/// reported, and no face through another (exact for rectangular units). None if all is well.
/// O(faces log faces) for rectangular units.
///
/// Not covered: the order of the layers when shut; of splayed units, poses between those looked at;
/// without a card, the freedoms of more than 2000 faces.
[[nodiscard]] std::optional<Unsound> find_unsound(const PatchAssembly& made);

/// Designs, and lets only sound patterns pass: whoever writes a design's files gets it here.
///
/// @param report  optional: receives what is wrong (`Unsound::report`), and stays empty otherwise
/// @retval Internal  what was made is not sound: a fault in popcut
/// @retval Malformed, OutOfRange, Infeasible  as `design_assembly`
[[nodiscard]] Result<PatchAssembly> sound_design(const DesignSpec& spec,
                                                 const SurfaceAssets& assets,
                                                 std::string* report = nullptr,
                                                 const Progress& progress = {});

}  // namespace popcut::planning

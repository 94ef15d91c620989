// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/design/patches.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/verify.hpp"

namespace popcut::judge {

/// A part of a design that is not sound.
struct UnsoundPart {
  std::size_t number{};  ///< counted from 1
  std::string name;
  Result<VerifyReport> report;  ///< what fails; an error: the verifier cannot read the part
};

/// Why there is no design: it cannot be made, or what was made is not sound.
struct DesignFault {
  Error error;                     ///< the first failure
  std::vector<UnsoundPart> parts;  ///< empty if nothing was made
};

/// Has the verifier, which shares no code with the generator, look at each part as it would be
/// written: one piece, sound edges and faces, a tiled sheet, isometric poses, the freedoms that are
/// reported, and no face through another (exact for rectangular units). None if all is well; else
/// the error is Internal. Of rectangular units the verifier looks at the flat sheet, and how it
/// moves is proven (`has_rectangular_motion`): O(faces log faces).
///
/// Not covered: the order of the layers when shut; of splayed units, poses between those looked at;
/// without a card, the freedoms of more than 2000 faces.
[[nodiscard]] std::optional<DesignFault> find_unsound(const PatchAssembly& made);

/// What is wrong with the parts of a design and where, as a JSON document.
[[nodiscard]] std::string unsound_json(const std::vector<UnsoundPart>& parts);

/// Designs, and lets only sound patterns pass: whoever writes a design's files gets it here.
///
/// @retval Internal  what was made is not sound: a fault in popcut
/// @retval Malformed, OutOfRange, Infeasible  as `design_assembly`
[[nodiscard]] tl::expected<PatchAssembly, DesignFault> sound_design(const DesignSpec& spec,
                                                                    const SurfaceAssets& assets,
                                                                    const Progress& progress = {});

}  // namespace popcut::judge

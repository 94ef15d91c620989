// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/patches.hpp"
#include "core/drawing/linework.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// A picture of a drawing, in mm: cuts black, mountains red, valleys blue, scores
/// and drawn lines green. Nothing of the file's own text is in it. At most about a million points;
/// a larger drawing is shown in part, and says so.
[[nodiscard]] std::string preview_svg(const LineWork& work);

/// A picture with the reason why there is no preview.
[[nodiscard]] std::string no_preview_svg(const std::string& why);

/// The lattice blob of a design, with all that a page shows of it.
///
/// @retval OutOfRange  as `lattice_blob`
[[nodiscard]] Result<std::string> shown_blob(const PatchAssembly& made, LatticeQuality quality);

}  // namespace popcut::planning

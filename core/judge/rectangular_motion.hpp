// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "core/pattern/pattern.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::judge {

/// Whether the motion of a pattern of rectangular units is proven to be sound, in O(faces): one
/// comparison a face and fold, where the verifier measures poses. False proves nothing.
///
/// A vertex (x, z, v) lies at (x + wall - z, v) on the sheet and at (x + z cos psi, v, z sin psi)
/// at the opening angle psi. Thus:
/// - a face whose corners have one x, or one z, keeps its shape at every psi;
/// - a fold between an upright and a level face turns by pi - psi: a valley if the upright one has
///   the smaller u, else a mountain;
/// - at 0 < psi < pi a place in space has one x, z and v, and these have one place on the sheet, so
///   that faces that tile the sheet meet nowhere but where they are joined;
/// - the freedoms are those of the section (`rigid::mobility`).
///
/// @param sheet     which faces meet in folds: `verify::make_sheet` of the pattern's model, which
///                  tiles the sheet
/// @param freedoms  how many there must be; none: not counted
[[nodiscard]] bool has_rectangular_motion(const Pattern& pattern, const verify::Sheet& sheet,
                                          std::optional<int> freedoms);

}  // namespace popcut::judge

// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut {

/// A material with settings that a person gives for one job: "cut: force=90 passes=2; fold:
/// speed=20". The words before the colon are those of a material: cut, fold, draw, score, light.
/// The settings are force (gf), speed (mm/s), passes, step (gf more on each further pass) and tool
/// (the holder).
///
/// @retval Usage  place is "/options/pen": an unknown word, a value out of its range, the same
///                setting twice, or `score` or `light` for a material without
[[nodiscard]] Result<Material> with_pens(Material material, std::string_view pens);

}  // namespace popcut

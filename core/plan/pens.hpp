// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut {

/// A material with the settings that a person gives for one job: "cut: force=90 passes=2; red:
/// speed=20". Before a colon stands a word of a material (cut, fold, draw, score, light), an
/// operation (mountain, valley, outline), a colour, or the name of a layer. The settings are force
/// (gf), speed (mm/s), passes, step (gf more on each further pass) and tool (the holder). What is
/// not a word of a material goes to `Material::pens`, in the order given, and changes what was
/// there under that name.
///
/// @retval Usage  place is "/options/pen": an unknown setting, a value out of its range, the same
///                setting twice, too many pens, or `score` or `light` for a material without
[[nodiscard]] Result<Material> with_pens(Material material, std::string_view pens);

/// The names of `Material::pens` that `with_pens` would add: pens of colours, layers, operations.
/// A text with errors, which `with_pens` finds, may give any names.
[[nodiscard]] std::vector<std::string> named_pens(std::string_view pens);

/// Gives the lines of an operation that has a pen ("mountain", "valley", "outline") to it, unless
/// they have one by their colour or layer.
void give_pens(LineWork& drawing, std::span<const PenSettings> pens);

/// Checks that each pen has a line.
///
/// @retval Usage  place is "/options/pen"; the detail lists what the drawing has
[[nodiscard]] Result<void> check_pens(const LineWork& drawing, std::span<const PenSettings> pens);

}  // namespace popcut

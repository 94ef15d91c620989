// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/formats/svg_reader.hpp"
#include "core/plan/linework.hpp"
#include "core/result.hpp"

namespace popcut::cli {

/// What `plan` and `cut` are given: a drawing, and the material its spec asks for.
struct DrawingInput {
  LineWork drawing;
  std::optional<std::string> material;
};

/// Reads a design spec (and designs it), a FOLD, SVG or DXF file, by its ending or else its first
/// character. A drawing without a name gets that of its file.
///
/// @retval Malformed, OutOfRange, Infeasible  with the file's name before the place
[[nodiscard]] Result<DrawingInput> read_drawing(const std::string& file, SvgProfile profile);

}  // namespace popcut::cli

// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "core/design/patches.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/result.hpp"
#include "daemon/planning/plan_input.hpp"

namespace popcut::cli {

using planning::DrawingInput;

/// What is called with the design of a spec, or a card of layers or of boxes, and the contents of
/// the files that it names; each may be empty.
struct DesignVisitor {
  std::function<Result<void>(const DesignSpec&, const SurfaceAssets&, const PatchAssembly&)>
      designed;
  std::function<Result<void>(const DesignSpec&, const SurfaceAssets&, const LayeredCard&)> layered;
  std::function<Result<void>()> sliced{};  ///< told of a card of slices, and may refuse it
  std::function<Result<void>(const DesignSpec&, const SurfaceAssets&, const BoxedCard&)> boxed{};
};

/// Reads a design spec (and designs it), a FOLD, SVG or DXF file, by its ending or else its first
/// character. A drawing without a name gets that of its file. `how` is for drawings with curves and
/// strokes; its limits are raised by POPCUT_RAISE_LIMITS, a factor from 1 to 100. A book
/// (`names_book`) is its cards side by side, parted by seams. Errors of `designed` are
/// returned.
///
/// @retval Malformed, OutOfRange, Infeasible  with the file's name before the place
/// @retval Usage  POPCUT_RAISE_LIMITS is no such factor
[[nodiscard]] Result<DrawingInput> read_drawing(const std::string& file, SvgReadOptions how,
                                                const std::vector<std::string>& tables = {},
                                                const std::string& material = "",
                                                const Progress& progress = {},
                                                const DesignVisitor& designed = {});

/// The same with a built-in profile and the usual options.
[[nodiscard]] Result<DrawingInput> read_drawing(const std::string& file, SvgProfile profile,
                                                const std::vector<std::string>& tables = {});

/// Why a file that is neither a design nor a drawing is refused, and what to do with it.
/// @param bytes  how it begins, if it was read
[[nodiscard]] Error neither_design_nor_drawing(const std::string& file,
                                               std::string_view bytes = {});

}  // namespace popcut::cli

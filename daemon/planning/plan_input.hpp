// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/boxes/boxed_card.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/design/patches.hpp"
#include "core/drawing/linework.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/plan/plan.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// The input of a plan: a drawing, and the material its spec asks for.
struct DrawingInput {
  LineWork drawing;
  std::optional<std::string> material;
  std::string pens{};              ///< a spec's own, see `with_pens`
  std::vector<double> seams_x{};   ///< split it there, mm from its left edge
  std::optional<PagePoint> at{};   ///< where it goes on a sheet unless the options say
  std::vector<DrawnPart> parts{};  ///< of a book: its cards
  std::size_t waste{};             ///< of a design: pieces that are taken out
  std::size_t tabs{};              ///< of a card of several parts: what is glued
  Polylines glue_marks{};          ///< see `Plan`
};

/// Sheets that belong together in one row, in this order: each is a part, and a piece of its own.
[[nodiscard]] DrawingInput side_by_side(std::span<const LineWork> sheets);

enum class InputKind : std::uint8_t { Spec, Fold, Svg, Dxf, Pdf };

/// What designing a spec needs from outside.
struct SpecSources {
  std::function<Result<SurfaceAssets>(const DesignSpec&)> assets;  ///< the files its surfaces name
  /// Optional: receives the design before it is drawn, and may add notes to its report.
  std::function<Result<void>(const DesignSpec&, PatchAssembly&)> designed{};
  std::vector<std::string> tables{};  ///< users' tables of materials
  std::string material{};             ///< that it will be cut from; empty: the spec's
  Progress progress{};                ///< told while a spec is designed
  /// Optional: receives a card of layers.
  std::function<Result<void>(const DesignSpec&, const LayeredCard&)> layered{};
  /// Optional: told of a card of slices before it is designed, and may refuse it.
  std::function<Result<void>()> sliced{};
  /// Optional: receives a card of boxes.
  std::function<Result<void>(const DesignSpec&, const BoxedCard&)> boxed{};
};

/// Reads a drawing, or designs a spec. `factor` raises the limits of FOLD and DXF files; those of
/// SVG are in `how`. A PDF is read in this process: only a worker should get one (`has_pdf`).
///
/// @retval Malformed, OutOfRange, Infeasible  places are within the text
/// @retval Internal  the spec's design is not sound (`sound_design`)
[[nodiscard]] Result<DrawingInput> drawing_from_text(std::string text, InputKind kind,
                                                     const SvgReadOptions& how, unsigned factor,
                                                     const SpecSources& sources);

/// The small test shape, near the sheet's corner.
[[nodiscard]] DrawingInput test_shape_input();

/// What a file is, by its content alone: JSON with "popcut" is a spec, with "file_spec" or
/// "vertices_coords" a FOLD file, and so is a crease pattern (.cp, .opx); what begins with '<' or
/// is a gzip is an SVG, with a group code a DXF, with "%PDF-" a PDF.
///
/// @retval Malformed  none of these, or JSON that breaks before its kind is known (line and column)
[[nodiscard]] Result<InputKind> kind_of_content(std::string_view text);

/// "spec", "fold", "svg", "dxf", "pdf".
[[nodiscard]] std::string_view name_of(InputKind kind);
/// @retval OutOfRange  none of these
[[nodiscard]] Result<InputKind> input_kind_from(std::string_view name);

}  // namespace popcut::planning

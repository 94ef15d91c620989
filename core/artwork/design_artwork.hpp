// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "core/artwork/artwork.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/design/design.hpp"
#include "core/design/patches.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// What of a model is printed on a pop-up.
enum class PrintMode : std::uint8_t {
  View,     ///< the model as it is seen from half way between ground and wall
  Surface,  ///< at each place the colour of the model's nearest point
  Flat,     ///< an image over the flat sheet
  Lines,    ///< edges of the model and shades of the panels, as lines
};

struct ArtworkOptions {
  PrintMode mode{PrintMode::View};
  double pixel_mm{25.4 / 300};
  Trapping trapping{};
  double shade{0};        ///< see `Lighting`
  bool bare_card{false};  ///< wall and ground stay paper, with `Surface`
  Progress progress{};
};

/// A model that stands as its design's target does: x and z those of the section at the design's
/// angle, v that of the sheet, mm.
///
/// @param model  in units and axes of the spec's surface
[[nodiscard]] ColourMesh model_on_sheet(ColourMesh model, const TargetPlacement& placement,
                                        const Design& design);

/// The target of a design as a model of clay, in the same way.
[[nodiscard]] ColourMesh clay_on_sheet(const Design& design);

/// How far artwork reaches beyond what is cut, mm: paper that is cut a little off its line is
/// printed.
[[nodiscard]] double artwork_margin_mm(const ArtworkOptions& options);

/// The frame of pixels of artwork for a page of paper, in mm.
///
/// @retval OutOfRange  more than `kMaxPixels`
[[nodiscard]] Result<PixelFrame> artwork_frame(const Box& page, const ArtworkOptions& options);

/// What is printed on a design, all of its parts on one page (`Pattern::place`).
///
/// @param models  one a part, see `model_on_sheet`; not looked at for `Flat`
/// @param image   for `Flat`
/// @retval OutOfRange  more than `kMaxPixels`; a face is not a simple polygon
/// @retval Infeasible  with `View`: nothing of the models is seen on the card
[[nodiscard]] Result<Artwork> design_artwork(std::span<const Pattern* const> parts,
                                             std::span<const ColourMesh> models,
                                             const Texture* image, const ArtworkOptions& options);

}  // namespace popcut

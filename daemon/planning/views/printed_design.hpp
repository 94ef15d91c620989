// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/design/boxes/boxed_card.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/design/patches.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// A card of layers, and the model whose colours are printed on it (`model_on_card`).
struct PrintedLayers {
  LayeredCard card;
  ColourMesh model;
};

/// The same of a card of boxes.
struct PrintedBoxes {
  BoxedCard card;
  ColourMesh model;
};

/// A design, and the models whose colours are printed on its parts.
struct PrintedDesign {
  std::vector<Pattern> parts;
  std::vector<ColourMesh> models;         ///< one a part
  bool coloured{false};                   ///< they have colours of their own
  bool around{false};                     ///< the parts are the cards of a book
  std::optional<PrintedLayers> layers{};  ///< in place of parts and models
  std::optional<PrintedBoxes> boxes{};    ///< the same

  [[nodiscard]] bool empty() const { return parts.empty() && !layers && !boxes; }
};

/// @param model  in units and axes of the spec's surface; none: the shape itself, as clay
[[nodiscard]] PrintedDesign printed_layers(const LayeredCard& made,
                                           const std::optional<ColourMesh>& model);

[[nodiscard]] PrintedDesign printed_boxes(const BoxedCard& made,
                                          const std::optional<ColourMesh>& model);

/// How much of a model's colour depends on the light, unless somebody says so: colours that were
/// painted on have their shades already.
[[nodiscard]] double usual_shade(const PrintedDesign& design);

/// The model in an asset with its colours: what it names is in it, or nowhere.
///
/// @param id    what errors call it
/// @param clay  its colours are not looked for, and all of it is clay
/// @retval Malformed, OutOfRange  as `read_colour_mesh`
[[nodiscard]] Result<ColourMesh> asset_colours(const std::string& id, const std::string& bytes,
                                               bool clay);

/// @param assets  those of the spec
/// @param model   in units and axes of the spec's surface; each card of a book shows its part of
/// it;
///                none: the design's own shape, as clay
/// @retval Malformed, OutOfRange  as `book_placement`
[[nodiscard]] Result<PrintedDesign> printed_design(const DesignSpec& spec,
                                                   const SurfaceAssets& assets,
                                                   const PatchAssembly& made,
                                                   const std::optional<ColourMesh>& model);

/// What is printed on a planned design, on the pattern's own page.
///
/// @param how    pixel and trapping in mm of the sheet, on which the pattern may be larger or
///               smaller than it was designed
/// @param image  for `PrintMode::Flat`
/// @retval OutOfRange  as `design_artwork`
[[nodiscard]] Result<Artwork> planned_artwork(const PrintedDesign& design, const Plan& plan,
                                              const Texture* image, ArtworkOptions how);

}  // namespace popcut::planning

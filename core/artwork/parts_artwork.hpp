// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "core/artwork/artwork.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/artwork/face_pixels.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/vec.hpp"
#include "core/parts/structure.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut {

/// A model, its corners less `origin` after it is placed in the corner of wall and ground, mm.
[[nodiscard]] ColourMesh placed_model(ColourMesh model, const TargetPlacement& placement,
                                      const Vec3& origin);
/// A target in clay.
[[nodiscard]] ColourMesh clay_model(const TriangleSoup& target);

/// Draws what is printed on a part, on the pixels of a frame around it; none: it stays bare.
using DrawPart = std::function<std::optional<ColourImage>(std::size_t part, const FaceSurface&,
                                                          const PixelFrame&)>;

/// What is printed on a card of several parts, on their common page: what `draw` draws on each,
/// trapped at its cuts.
///
/// @param pose    of the open card
/// @param places  of the parts on their common page (`Plan::parts`): x = v, y = u of each sheet
/// @retval OutOfRange  more than `kMaxPixels`; a mode that is not for cards of parts
[[nodiscard]] Result<Artwork> parts_artwork(const Structure& card, const PartPoses& pose,
                                            std::span<const DrawnPart> places,
                                            const ArtworkOptions& options, const DrawPart& draw);

/// The printed card in a pose, without its tabs. The printed sides are where triangles run
/// counter-clockwise.
[[nodiscard]] ColourMesh standing_parts(const Structure& card, const PartPoses& pose,
                                        std::span<const DrawnPart> places, const Artwork& artwork);

}  // namespace popcut

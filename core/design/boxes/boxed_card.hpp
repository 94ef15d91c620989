// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/compare/comparison.hpp"
#include "core/design/boxes/block_row.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/fit/fit_figures.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/tent_section.hpp"
#include "core/hands/folding.hpp"
#include "core/parts/structure.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

/// A box or a tent of a card: `block` in places of the card, y along its spine.
struct CardBox {
  std::string name;
  Block block;
  std::size_t first_part{}, parts{};
  std::size_t panels{};                   ///< faces without tabs
  std::optional<std::size_t> inner_part;  ///< the wall inside it, which nobody sees
  double inner_mm{};                      ///< its height; 0: none
  double bend_mm{};                       ///< as of a `BoxElement`
  double off_mm{};                        ///< from the middles of its ends to the ends of its block
};

/// A roof that is glued on a sheet of facets (docs/facets.md).
struct CardTent {
  std::string name;
  TentSection section;
  std::array<double, 2> along_mm{};  ///< from and to along the spine
  std::size_t roof_part{}, strut_part{};
};

/// A target as boxes and tents in a row over the spine of a card that opens flat (docs/parts.md),
/// or as facets with glued roofs on a card that opens to 90 degrees (`tented_card`).
struct BoxedCard {
  Structure card;
  std::vector<CardBox> boxes;
  std::vector<CardTent> tents;  ///< of facets alone, which have no boxes
  /// How a point of the surface comes to its place on the open card: placed in the corner, moved by
  /// -`origin`, turned about the vertical by `turn_rad`, moved by `shift`. There u is across the
  /// pages, v along the spine, z up.
  TargetPlacement placement;
  Vec3 origin{0.0, 0.0, 0.0};
  double turn_rad{};
  Vec3 shift{0.0, 0.0, 0.0};
  TriangleSoup target;  ///< as it stands on the open card
  /// The panels of the open card against what is seen of the target from above and from its sides,
  /// both ways; nothing is out of reach.
  FitFigures fit;
  likeness::Figures seen;  ///< the same as it is seen: from the nine directions of a card
  std::size_t panels{};    ///< of all boxes
  std::size_t folds{}, tabs{};
  hands::Handwork handwork;
  std::optional<double> wobble_mm;  ///< as verify measures it; none: not judged
  std::vector<Warning> warnings;

  /// Whether the target's front, its x axis, looks along the spine; else along u.
  [[nodiscard]] bool faces_along_spine() const { return std::sin(turn_rad) > std::cos(turn_rad); }
  /// Whether it is a sheet of facets with glued roofs.
  [[nodiscard]] bool is_of_facets() const { return !tents.empty(); }
  /// Whether nothing is printed on a part: inner walls, struts, and pages that carry boxes.
  [[nodiscard]] bool is_bare(std::size_t part) const {
    return is_inner(part) || (part == 0 && !is_of_facets()) ||
           std::any_of(tents.begin(), tents.end(),
                       [&](const CardTent& tent) { return tent.strut_part == part; });
  }
  /// Whether a part is the wall inside a box.
  [[nodiscard]] bool is_inner(std::size_t part) const {
    return std::any_of(boxes.begin(), boxes.end(),
                       [&](const CardBox& box) { return box.inner_part == part; });
  }
  /// How far from a part the target may be to be printed on it as lying on it: bent ends are a
  /// little off the target's.
  [[nodiscard]] double near_mm(std::size_t part) const;
  /// Mean distance of both surfaces from each other, over the size of the target.
  [[nodiscard]] double error() const {
    return 0.5 * (fit.to_target.mean_mm + fit.to_structure.mean_mm) / fit.size_mm;
  }
};

/// Fits boxes with flat, gabled and pyramid roofs, and tents, to a target (`block_row`). The spine
/// lies below their ridges. Boxes that touch stand a thickness of paper apart, and their ends fold
/// inward there. Where it is possible, both ends of a box fold the same way, and an inner wall
/// holds their middles.
///
/// @retval Malformed, OutOfRange  the surface cannot be read
/// @retval Infeasible  it is too small, it has no upright walls with such roofs, it needs more
/// boxes
///                     than asked for, or a given page is too small: with the least that holds them
[[nodiscard]] Result<BoxedCard> boxed_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                           const Progress& progress = {});

/// A panel of the open card.
struct OpenPanel {
  std::size_t part{};
  TriangleSoup triangles;  ///< counter-clockwise on the printed side, mm
};

/// The panels of the open card: all faces but pages, tabs and inner walls.
[[nodiscard]] std::vector<OpenPanel> open_panels(const BoxedCard& made);

/// Compares the panels of the open card (`open_panels`) with the target.
void measure(BoxedCard& made);

/// All faces at an opening of the pages; z up, x to the right along u. Both pages slope alike, or
/// the right one is level on a card that opens to 90 degrees.
[[nodiscard]] PartPoses pose_at(const BoxedCard& made, double opening_rad);
/// The same of the open card.
[[nodiscard]] PartPoses open_pose(const BoxedCard& made);

/// Corners of an open card or its target as they are seen by who looks at the target's front, which
/// looks along x.
[[nodiscard]] std::vector<float> seen_in_front(const TriangleSoup& soup, bool faces_along_spine);

/// Moves points (x, y, z one after the other, mm, as placed in the corner less `origin`) to their
/// places on the card.
void move_to_card(const BoxedCard& made, std::vector<double>& corners);

}  // namespace popcut

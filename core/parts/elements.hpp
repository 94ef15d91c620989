// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/tent_section.hpp"
#include "core/parts/structure.hpp"
#include "core/result.hpp"

namespace popcut {

// Elements of cards that open flat, with closed forms for every opening 0 < opening < pi of the
// fold that they stand on (docs/parts.md). Each has conditions to open and to shut; `add` refuses
// what does not meet them, and says what would have to change.

/// Two panels that meet in a ridge. Their creases leave the fold at one point, the apex, at angles
/// from the direction of the fold; the panels have the angles between crease and ridge.
///
/// It shuts flat if crease + panel is the same on both sides, S. It opens, and stays off the faces,
/// if left crease + right crease < S < pi.
struct VFoldElement {
  std::string name{"v-fold"};
  double at_mm{};  ///< the apex, along the fold
  double left_crease_rad{}, right_crease_rad{};
  double left_panel_rad{}, right_panel_rad{};
  double crease_mm{}, ridge_mm{};  ///< of the panels, parallelograms where no outline is given
  /// Outlines on the panels' sheet: the apex is (0, 0), the ridge runs up, the right panel has
  /// u > 0. They lie between ridge and crease. A panel with holes is of several faces that touch.
  std::vector<std::vector<Vec2>> left_outlines, right_outlines;
  /// Where tabs are, from and to along each crease; none: all of it but what is near the apex.
  std::vector<std::pair<double, double>> left_tabs, right_tabs;
  bool tabs_behind{true};  ///< they lie on the side towards the fold's beginning
};

/// The panel angles of a symmetric V-fold whose ridge is inclined by `tilt_rad` to the pages that
/// lie flat: cos(panel) = cos(crease) cos(tilt).
[[nodiscard]] double panel_of_tilt(double crease_rad, double tilt_rad);

/// A roof over the fold: panels from a line on each face, parallel to the fold, to a ridge.
///
/// It shuts if foot + panel is the same on both sides, and opens if left foot + right foot < left
/// panel + right panel.
struct TentElement {
  std::string name{"tent"};
  double from_mm{}, to_mm{};  ///< along the fold
  double left_foot_mm{}, right_foot_mm{}, left_panel_mm{}, right_panel_mm{};
  std::vector<std::pair<double, double>> slits;  ///< in the ridge, along the fold
};

/// A panel parallel to the fold that stands on the right face, and a strut from the left face that
/// holds it: a tent, one of whose panels goes on beyond the ridge.
struct LayerElement {
  std::string name{"layer"};
  double from_mm{}, to_mm{};
  double foot_mm{}, height_mm{};  ///< of the layer
  double strut_at_mm{};           ///< on the layer, from its foot
  double strut_foot_mm{}, strut_mm{};
  bool tab_down{};  ///< the strut's tab on the layer points to its foot, not away from it
};

/// The strut that makes a layer stand upright on pages that lie flat: its foot and its length.
[[nodiscard]] std::pair<double, double> upright_strut(double foot_mm, double strut_at_mm);

enum class BoxLid {
  None,
  Roof,      ///< level on pages that lie flat; it rises in the middle as they shut
  Gabled,    ///< two slopes from the walls to a ridge over the fold, with gables below them
  Floating,  ///< a copy of both faces, raised by the walls' height
  Pyramid    ///< two slopes and, at the ends, two more that are folded in the middle
};

/// Two walls parallel to the fold, joined by ends that are folded in the middle. The walls always
/// stand in the direction between the faces.
///
/// Shut it reaches half + height from the fold, with a roof 2 half + height, a floating lid
/// lid + height. A gabled roof of slopes p = sqrt(half^2 + rise^2) reaches half + height + p, as
/// does a pyramid; the ridge is sqrt(p^2 - half^2 sin^2(opening / 2)) above the walls, so it stays
/// above the gables. A pyramid's slopes at the ends are not held by the ends: they fold outward,
/// and rise above the walls.
///
/// An end folds outward or into the box. Both can fold inward if 2 half < length; two ends that
/// fold the same way stay parallel, so that an inner wall between their middles can hold them.
///
/// Ends that lie in one plane on open pages are held badly: where a fold is off by d, their middle
/// moves by d tan(opening / 2). With a bend, they are sqrt(half^2 + bend^2) wide on each side, and
/// their middle stays out of that plane.
struct BoxElement {
  std::string name{"box"};
  double from_mm{}, to_mm{};
  double half_mm{}, height_mm{};
  BoxLid lid{BoxLid::None};
  double lid_mm{};    ///< of each half of a floating lid; at least `half_mm`
  double rise_mm{};   ///< of a ridge or a pyramid's top above the walls, on pages that lie flat
  double eaves_mm{};  ///< of a gabled roof beyond the walls, down its slope
  std::array<double, 2> verge_mm{};          ///< the same beyond both ends, along the fold
  std::array<bool, 2> ends_out{true, true};  ///< which of both ends fold outward
  std::array<bool, 2> has_hips{true, true};  ///< whether a pyramid has slopes at its ends
  /// From the middle of an end to the line between its walls, on pages that lie flat; and the same,
  /// outward, at the foot of a pyramid's slope there.
  double bend_mm{}, hip_bend_mm{};
  double inner_mm{};  ///< height of a wall from the middle of one end to that of the other; 0: none
};

/// The middle of the foot of a pyramid's slope at an end: outward from the pyramid's middle, and up
/// from the tops of its walls.
[[nodiscard]] Vec2 hip_foot(const BoxElement& pyramid, double opening_rad);

/// Two corners back to back: a panel that stands in the fold, with steps on both sides of it, each
/// an upright panel and a level one. Without a lock it has two freedoms: tents at both ends,
/// through whose ridges fingers of the panel slide, hold it in the middle.
struct DoubleCornerElement {
  struct Step {
    bool is_right{};
    double from_mm{}, to_mm{};
    double out_mm{}, up_mm{};
  };
  std::string name{"corner"};
  double from_mm{}, to_mm{};  ///< of the panel in the fold, without the locks
  double height_mm{};
  std::vector<Step> steps;
  bool has_locks{true};
  double lock_foot_mm{12.0}, lock_panel_mm{20.0}, lock_width_mm{18.0};
};

/// Whether an element opens and shuts, whatever the pages.
///
/// @retval OutOfRange  an angle or a length that is not valid
/// @retval Infeasible  it does not shut or not open; says by how much
[[nodiscard]] Result<void> can_move(const VFoldElement& element);
[[nodiscard]] Result<void> can_move(const TentElement& element);
[[nodiscard]] Result<void> can_move(const LayerElement& element);
[[nodiscard]] Result<void> can_move(const BoxElement& element);
[[nodiscard]] Result<void> can_move(const DoubleCornerElement& element);

/// Adds the parts of an element to a card, whether it can move or not.
void build(Structure& card, const Seat& seat, const VFoldElement& element);
void build(Structure& card, const Seat& seat, const TentElement& element);
void build(Structure& card, const Seat& seat, const LayerElement& element);
void build(Structure& card, const Seat& seat, const BoxElement& element);
void build(Structure& card, const Seat& seat, const DoubleCornerElement& element);

/// Adds a glued roof and its strut to a sheet of facets, from `from_mm` to `to_mm` along the fold.
///
/// @param seat   the fold between the upright panel behind the roof and the level panel below it
/// @param front  the face that the level panel's eave is a fold of, too: the roof's tab lies on it
void add_glued_roof(Structure& card, const Seat& seat, std::uint32_t front,
                    const TentSection& section, const std::string& name, double from_mm,
                    double to_mm);

/// Whether the parts from `first_part` on lie inside the pages when the card is shut.
///
/// @retval Infeasible  they stick out; says where, by how much, and the page that would hold them
[[nodiscard]] Result<void> shuts_inside(const Structure& card, std::size_t first_part);

/// Adds an element that can move and shuts inside the pages; the card is as it was if not.
template <typename Kind>
[[nodiscard]] Result<void> add(Structure& card, const Seat& seat, const Kind& element) {
  if (auto moves = can_move(element); !moves) return moves;
  Structure with = card;
  build(with, seat, element);
  if (auto inside = shuts_inside(with, card.parts.size()); !inside) return inside;
  card = std::move(with);
  return {};
}

/// The seat on the crease of a V-fold, or on the foot of another panel that a tab holds: the fold
/// between the panel of `tab` and the face that it is glued to, on the side that the tab is not on.
///
/// @param joint  of the tab, in `Structure::joints`
[[nodiscard]] Seat seat_beside(const Structure& card, std::size_t joint);

}  // namespace popcut

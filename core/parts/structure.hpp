// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/geometry/vec.hpp"

namespace popcut {

/// A flat line, mm: two points.
using FlatLine = std::array<Vec2, 2>;

/// A part of a card of several parts: a sheet whose faces meet in folds. Faces are simple polygons,
/// counter-clockwise; neighbours share the vertices of the fold between them.
struct SheetPart {
  std::string name;
  std::vector<Vec2> vertices;
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::uint32_t> tabs;  ///< faces that are glued
  std::vector<FlatLine> slits;      ///< cuts between faces that share the line

  /// Adds a face. Its corners are the same vertices as those of other faces at the same places.
  std::uint32_t add_face(std::span<const Vec2> corners);
  /// Makes a place on a side of a face a corner of it. Nothing where it is one, or on no side.
  void add_corner(Vec2 at);
  /// Whether a line between two vertices is cut.
  [[nodiscard]] bool is_slit(std::uint32_t from, std::uint32_t to) const;
};

/// A side of a joint: a face of a part, and a line on its sheet.
struct PartSide {
  std::size_t part{};
  std::uint32_t face{};
  FlatLine line;
};

enum class PartJointKind : std::uint8_t { Hinge, Glue, Slot, Cross };

/// What holds two parts together, as verify's `CardJoint`.
struct PartJoint {
  PartJointKind kind{};
  PartSide a, b;
  bool turned{};
};

/// One side of the fold that an element stands on: where on a face the fold begins, its direction,
/// and which way the face goes from it, square to the fold; both of length 1.
struct SeatSide {
  std::size_t part{};
  std::uint32_t face{};
  Vec2 origin, along, away;

  /// The place `out_mm` away from the fold, and `along_mm` along it.
  [[nodiscard]] Vec2 at(double out_mm, double along_mm) const {
    return origin + along_mm * along + out_mm * away;
  }
};

/// A fold whose faces open from 0 (shut) to at most pi, and that an element is glued to.
struct Seat {
  SeatSide left, right;
};

/// Where an element stands at one opening: its own axes in space. x points from left to right, y
/// along the fold, z between the faces; the faces are at half of `opening_rad` from z.
struct SeatFrame {
  Eigen::Isometry3d to_space;
  double opening_rad{};

  /// Along the right face, away from the fold; the left one has -x.
  [[nodiscard]] Vec3 out(double side) const;
};

/// Places of the faces of parts in space, one a face.
using PartPoses = std::vector<std::vector<Eigen::Isometry3d>>;

/// What moves the faces that an element added: the places of its own panels (not its tabs) at an
/// opening of its seat, in the seat's axes. `parts` are the element's parts in order.
struct Element {
  Seat seat;
  std::size_t first_part{}, parts{};
  std::function<PartPoses(const SeatFrame&)> pose;
};

/// Where a face of the first part lies: parallel to the left page (upright) or to the right one, so
/// far from it. It stays so while the card opens.
struct SheetPlane {
  bool upright{};
  double offset_mm{};
};

/// A card of several parts. The first part is the card: two pages with the spine between them, the
/// left page `u < 0`, the right page `u > 0`, v along the spine.
struct Structure {
  std::string name{"card"};
  double page_mm{}, length_mm{};  ///< of each page: from the spine outward, and along it
  double thickness_mm{0.3};       ///< of the paper
  double opens_deg{180.0};        ///< between the pages of the open card
  double tab_mm{8.0};             ///< depth of glued tabs
  std::vector<SheetPart> parts;
  std::array<std::uint32_t, 2> pages{0, 1};  ///< faces of the first part: left and right
  /// Of all faces of the first part, where that has more than its pages.
  std::vector<SheetPlane> planes;
  std::vector<PartJoint> joints;
  std::vector<Element> elements;
};

/// Two pages and nothing on them.
[[nodiscard]] Structure plain_card(double page_mm, double length_mm);

/// The fold between the pages; elements stand on it at y = v.
[[nodiscard]] Seat spine_of(const Structure& card);

/// The motion from a flat sheet that lays three of its points on three points in space. The first
/// goes there exactly, the second in its direction, the third on its side.
[[nodiscard]] Eigen::Isometry3d laid(const std::array<Vec2, 3>& flat,
                                     const std::array<Vec3, 3>& space);

/// The motion that lays a sheet on another, line on line; `turned` over, or not.
[[nodiscard]] Eigen::Isometry3d glued(const FlatLine& from, const FlatLine& to, bool turned);

/// How deep a tab along a fold is: the card's `tab_mm`, or less where the fold is short.
[[nodiscard]] double tab_depth_mm(const Structure& card, double fold_mm);

/// Adds a tab to a panel along `fold`, and glues it. It lies on the other face along `to`, on its
/// left (`on_left`) going from `to[0]` to `to[1]`.
///
/// @param part  with the panel, whose border runs along `fold`; the card's parts and joints grow
void add_tab(Structure& card, std::size_t part, const FlatLine& fold, std::size_t on_part,
             std::uint32_t on_face, const FlatLine& to, bool on_left);

/// Turns a part that nothing else stands on over on its sheet: what was its back is printed, and
/// mountains are valleys. The card stays as it is.
void turn_over(Structure& card, std::size_t part);

/// The places of all faces at an opening of the pages, 0 < opening < pi, by the elements' closed
/// forms. The right page stays where its sheet is flat; z is up.
[[nodiscard]] PartPoses posed(const Structure& card, double opening_rad);

/// A fold of a part at an opening, or a slit.
struct PartFold {
  std::uint32_t from{}, to{};     ///< vertices
  std::uint32_t left{}, right{};  ///< faces
  double angle_rad{};             ///< valley positive
};
[[nodiscard]] std::vector<PartFold> folds_of(const SheetPart& part,
                                             std::span<const Eigen::Isometry3d> pose);

}  // namespace popcut

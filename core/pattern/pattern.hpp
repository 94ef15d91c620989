// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/kite.hpp"

namespace popcut {

/// What an edge of a pattern is.
enum class EdgeRole : std::uint8_t {
  Mountain,  ///< fold from horizontal to vertical going outward; FOLD angle -(pi - psi)
  Valley,    ///< fold from vertical to horizontal, also the spine; FOLD angle +(pi - psi)
  Slit,      ///< one side of a cut inside the sheet
  Outline,   ///< the sheet's own border
};

/// A vertex of the pattern by its place in the pose psi = pi/2, in mm. The same three
/// numbers give its place on the sheet and in every pose (docs/geometry.md, section 2): on the
/// sheet it is at `(u, v) = (x + (wall - z), v)`, opened to psi at `(x + z cos psi, v, z sin psi)`.
struct PatternVertex {
  double x{};
  double z{};
  double v{};
};

/// An edge between two vertices, and the faces to its left and right in `(u, v)`; -1: none.
struct PatternEdge {
  std::uint32_t from{};
  std::uint32_t to{};
  std::int32_t left{-1};
  std::int32_t right{-1};
  EdgeRole role{};
};

/// A straight line on the sheet, in mm, to cut or fold. Each line occurs once.
struct SheetLine {
  double u0{}, v0{};
  double u1{}, v1{};
  EdgeRole role{};
};

/// A V-fold on a valley crease (docs/geometry.md, section 7): two triangles reach from the apex O
/// `length_mm` along the crease to its tip A and `alpha` times that to either side.
struct VFold {
  std::uint32_t apex{};    ///< O, on the crease
  std::uint32_t tip{};     ///< A on the triangles; it leaves the crease when the card opens
  std::uint32_t edge_b{};  ///< fold O-B on the upright panel
  std::uint32_t edge_c{};  ///< fold O-C on the level panel
  double length_mm{};      ///< w
  double alpha{};          ///< tan of the splay angle
};

/// Two sloped panels (core/geometry/kite.hpp). Their vertices have the places of the stair that the
/// kite is the mirror image of, so that they are where they should be on the sheet.
struct Kite {
  KiteSection section;
  double v0_mm{}, v1_mm{};              ///< along the spine
  std::vector<std::uint32_t> vertices;  ///< of its panels, but those on its outer folds
  std::vector<std::uint32_t> faces;     ///< its two panels
  std::vector<std::uint32_t> edges;     ///< its outer folds, at Q and at E
};

/// A stretch of the sheet's own edge that is glued to another pattern (docs/geometry.md, section
/// 5): the line from (u0_mm, v_mm) to (u1_mm, v_mm), with a margin on either side of it.
struct Seam {
  std::int32_t id{};     ///< number of the seam, the same on both patterns
  std::int32_t other{};  ///< index of the pattern on the other side
  double v_mm{};         ///< 0 or the pattern's width
  double u0_mm{}, u1_mm{};
};

/// Where the corner (u, v) = (0, 0) of a pattern lies in the whole made of several patterns.
struct PatternPlace {
  double u_mm{}, v_mm{};
};

/// A single-sheet cut-and-fold pattern, flat and in split form: each side of a cut has its own
/// vertices, so that the faces on both sides can separate. The sides share the vertices where a cut
/// ends.
struct Pattern {
  std::string name;
  double wall_mm{};    ///< H: the spine lies at u = wall_mm
  double ground_mm{};  ///< D: with a card the sheet is [0, H + D] x [0, width_mm]
  double width_mm{};   ///< W, along the spine
  bool card{true};     ///< false: only the strips, without wall and ground
  double design_psi_rad{std::numbers::pi / 2};  ///< opening angle that shows what was designed
  std::vector<PatternVertex> vertices;
  std::vector<PatternEdge> edges;
  std::vector<std::uint32_t> face_first;     ///< faces + 1 offsets into `face_vertices`
  std::vector<std::uint32_t> face_vertices;  ///< counter-clockwise in (u, v)
  std::vector<VFold> v_folds;
  std::vector<Kite> kites;
  std::vector<Seam> seams;  ///< empty if the pattern is the whole
  PatternPlace place;
  /// Where a model from a file stands in the designed pose, at (x, v, z): a point q of it is at
  /// `R_z R_y R_x (scale q) + shift`. Scale in mm, three turns in degrees, shift in mm.
  std::optional<std::array<double, 7>> model_placement;
  std::vector<SheetLine> lines;  ///< folds, slits and the outline, each once and not split

  [[nodiscard]] std::size_t faces() const { return face_first.empty() ? 0 : face_first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t i) const {
    return std::span(face_vertices).subspan(face_first[i], face_first[i + 1] - face_first[i]);
  }
  /// Sheet coordinate along the strips, in mm: the isometry of section 2.
  [[nodiscard]] double u(const PatternVertex& p) const { return p.x + (wall_mm - p.z); }
};

/// Where `p` lies when the card is opened to `psi_rad` (pi: flat, pi/2: the designed shape, 0:
/// shut), as (x, v, z) in mm: main text eq. 1 summed over the chain. Not valid for the tip of a
/// V-fold, nor on a kite.
[[nodiscard]] std::array<double, 3> posed(const PatternVertex& p, double psi_rad);

/// The same of a point of a kite.
[[nodiscard]] std::array<double, 3> posed(const Kite& kite, const PatternVertex& p, double psi_rad);

/// All vertices at `psi_rad`, including the tips of V-folds in their popped positions, and kites;
/// (x, v, z) in mm.
[[nodiscard]] std::vector<std::array<double, 3>> posed_vertices(const Pattern& pattern,
                                                                double psi_rad);

/// The angle between a V-fold's centre fold and its crease at `psi_rad`, in rad: 2 atan(alpha
/// cos(psi/2)), section 7. (S3 gives it as an arc tangent of a quotient, which jumps at pi/2.)
[[nodiscard]] double splay_rad(double alpha, double psi_rad);

/// FOLD angle of an edge in degrees at `psi_rad`: + for a valley, - for a mountain, 0 for a border.
[[nodiscard]] double fold_angle_deg(EdgeRole role, double psi_rad);

/// FOLD angles of all edges in degrees. The side folds of V-folds have 2 atan(sqrt(1 + alpha^2)
/// cot(psi/2)), the outer folds of kites `KiteSection::bend_rad`.
[[nodiscard]] std::vector<double> fold_angles_deg(const Pattern& pattern, double psi_rad);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace popcut {

/// What an edge of a pattern is.
enum class EdgeRole : std::uint8_t {
  Mountain,  ///< fold, horizontal then vertical going outward; FOLD angle -(pi - psi)
  Valley,    ///< fold, vertical then horizontal (the spine too); FOLD angle +(pi - psi)
  Slit,      ///< one side of a cut inside the sheet
  Outline,   ///< the sheet's own border
};

/// A vertex of the pattern by its place in the designed (psi = pi/2) pose, in mm. The same three
/// numbers give the sheet and every pose (design reference, section 2): on the sheet it lies at
/// `(u, v) = (x + (wall - z), v)`, deployed at `(x + z cos psi, v, z sin psi)`.
struct PatternVertex {
  double x{};
  double z{};
  double v{};
};

/// An edge between two vertices, with the faces to its left and right in `(u, v)`, -1 for none.
struct PatternEdge {
  std::uint32_t from{};
  std::uint32_t to{};
  std::int32_t left{-1};
  std::int32_t right{-1};
  EdgeRole role{};
};

/// A straight line on the sheet, in mm: what a person cuts or folds, each once.
struct SheetLine {
  double u0{}, v0{};
  double u1{}, v1{};
  EdgeRole role{};
};

/// A single-sheet cut-fold pattern, flat and in split form: along a cut each side has vertices of
/// its own, so that faces on either side can part. Vertices where a cut ends are shared.
struct Pattern {
  std::string name;
  double wall_mm{};    ///< H: the spine lies at u = wall_mm
  double ground_mm{};  ///< D: with a card the sheet is [0, H + D] x [0, width_mm]
  double width_mm{};   ///< W, along the spine
  bool card{true};     ///< false: the union of the strips, without wall and ground
  std::vector<PatternVertex> vertices;
  std::vector<PatternEdge> edges;
  std::vector<std::uint32_t> face_first;     ///< faces + 1 offsets into `face_vertices`
  std::vector<std::uint32_t> face_vertices;  ///< counter-clockwise in (u, v)
  std::vector<SheetLine> lines;  ///< folds, slits and the outline, each line once, unsplit

  [[nodiscard]] std::size_t faces() const { return face_first.empty() ? 0 : face_first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t i) const {
    return std::span(face_vertices).subspan(face_first[i], face_first[i + 1] - face_first[i]);
  }
  /// Sheet coordinate along the strips, in mm: the isometry of section 2.
  [[nodiscard]] double u(const PatternVertex& p) const { return p.x + (wall_mm - p.z); }
};

/// Where `p` lies when the card is opened to `psi_rad` (pi is flat, pi/2 the designed shape, 0
/// shut), as (x, v, z) in mm: main text eq. 1 summed over the chain.
[[nodiscard]] std::array<double, 3> posed(const PatternVertex& p, double psi_rad);

/// FOLD angle of an edge in degrees at `psi_rad`: + for a valley, - for a mountain, 0 for a border.
[[nodiscard]] double fold_angle_deg(EdgeRole role, double psi_rad);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/design.hpp"
#include "core/design/patches.hpp"
#include "core/geometry/vec.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

/// How good what is shown is: made in a moment while a hand moves, as its spec asks for it, or a
/// design that is kept.
enum class LatticeQuality : std::uint8_t { Draft, Exact, Stored };

/// What of a side of a triangle is drawn; the numbers are those of the blob.
enum class SideRole : std::uint8_t { Inside = 0, Outline = 1, Mountain = 2, Valley = 3, Slit = 4 };

/// A part of a card of several parts, whose faces follow those of the part before.
struct LatticePart {
  std::string name;
  std::uint32_t faces{};
  std::size_t folds{}, tabs{};
  std::array<double, 4> box_mm{};    ///< left, top, width and height on the page (v, u)
  std::array<double, 2> shift_mm{};  ///< (x, y) of its own sheet is at u = shift[0] - y,
                                     ///< v = shift[1] + x
};

/// What goes into a blob beside the pattern.
struct LatticeBlobOptions {
  LatticeQuality quality{LatticeQuality::Exact};
  std::string kind{"spec"};  ///< of the source: "spec", "fold", "svg", "dxf", "pdf"
  bool error{true};          ///< measure how far each face is from the target, where one is known
  bool curvature{false};     ///< K and H at fold vertices
  std::size_t most_ghost_triangles{0};  ///< of the target's ghost; 0: none
  std::vector<Warning> warnings{};      ///< after those of the design's own report
  std::vector<std::string> judged{},
      not_judged{};                  ///< what was checked of a pattern from elsewhere
  std::vector<LatticePart> parts{};  ///< of a pattern alone that is a card of several parts
  std::string report{};              ///< of a pattern alone: a JSON document; empty: none
  std::vector<SheetLine> others{};   ///< on the sheet, neither cut nor folded: role 0
};

/// How a pattern opens that popcut's own law of motion does not describe: the places (x, v, z) of
/// all its vertices at each of some opening angles. Without angles no motion is known.
struct LatticeFrames {
  std::vector<double> psi_rad;
  std::vector<std::vector<Vec3>> places;  ///< one list an angle, one place a vertex, mm
};

inline constexpr std::size_t kMaxLatticeBytes = std::size_t{256} << 20;

/// The lattice blob ("PCLB", version 1) of a pattern, docs/geometry.md, section 9: little-endian,
/// a head of JSON and then arrays of 32-bit floats, integers and bytes. One form for all that a
/// page draws in three dimensions: a design while it is made, a stored one, and a foreign pattern.
///
/// The points are the pattern's vertices in their order; where `motion` is "pose" they open by
/// `posed_vertices`; those of a pattern with kites come as frames. Faces are cut into triangles
/// along their own corners; a corner where the role of a straight side changes is one too, so that
/// each side of a triangle has one role. Memory is taken after all sizes are known.
///
/// @retval OutOfRange  more than `kMaxLatticeBytes`; a face is not a simple polygon with an area
///                     (`place` is "faces/N"); frames that have not a place for each vertex
[[nodiscard]] Result<std::string> lattice_blob(const Design& design,
                                               const LatticeBlobOptions& options = {});

/// The same of patches. Several parts, which are glued, stand side by side with their spines in
/// line, each at its `place`; `face_part` tells them apart, and slices count within each part.
[[nodiscard]] Result<std::string> lattice_blob(const PatchAssembly& assembly,
                                               const LatticeBlobOptions& options = {});

/// The same of a pattern alone, without report, slices and levels. It opens by popcut's own law.
[[nodiscard]] Result<std::string> lattice_blob(const Pattern& pattern,
                                               const LatticeBlobOptions& options = {});

/// The same of a pattern from elsewhere. Where it has no `lines`, its edges stand for them.
[[nodiscard]] Result<std::string> lattice_blob(const Pattern& pattern, const LatticeFrames& frames,
                                               const LatticeBlobOptions& options = {});

}  // namespace popcut

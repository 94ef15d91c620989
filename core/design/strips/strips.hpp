// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace popcut {

/// Identity of a plane. Panels of neighbouring strips are joined when, and only when, their plane
/// ids are equal; `unify_planes` sees to it that neighbours in one plane have one id.
using PlaneId = std::int32_t;
inline constexpr PlaneId kWallPlane = 0;    ///< x = 0
inline constexpr PlaneId kGroundPlane = 1;  ///< z = 0
/// No plane: a cut across the strip, where it goes on in another plane. Such a panel has no length
/// on the sheet (its ends have the same u) and no paper.
inline constexpr PlaneId kNoPlane = -1;

/// Whether a stretch of `length_mm` that two panels of one plane have in common joins them: paper
/// narrower than the smallest panel would tear, so it is cut.
[[nodiscard]] inline bool is_joint(double length_mm, double min_panel_mm) {
  constexpr double kRounding = 1e-6;
  return length_mm > 0.0 && length_mm >= (1.0 - kRounding) * min_panel_mm;
}

/// A bridge is a connector whose planes do not pair by level: between slices with another N. A
/// blank is a slice without structure, wall and ground alone.
enum class StripKind : std::uint8_t { Margin, Slice, Connector, Box, Bridge, Blank };

/// A row of strips along v, each a staircase of panels from the wall to the ground: monotone, but
/// where a cut across the strip (`kNoPlane`) parts it.
///
/// Strip `s` occupies `v_begin[s] .. v_begin[s + 1]` and has the panels
/// `first_panel[s] .. first_panel[s + 1]`. Panel `p` lies in plane `plane[p]`, from the point
/// `(x[q], z[q])` to the next one, `q = p + s` (each strip has one point more than panels).
struct Strips {
  std::vector<double> v_begin;      ///< strips + 1 boundaries, mm on the sheet
  std::vector<StripKind> kind;      ///< one a strip
  std::vector<std::int32_t> slice;  ///< slice (or left slice of a connector or bridge), -1: margin
  std::vector<std::uint32_t> first_panel;  ///< strips + 1 offsets
  std::vector<PlaneId> plane;              ///< one a panel
  std::vector<std::int32_t> level;         ///< level of the panel's plane, -1 for wall and ground
  std::vector<double> x;                   ///< staircase points, panels + 1 a strip
  std::vector<double> z;

  [[nodiscard]] std::size_t size() const { return kind.size(); }
  [[nodiscard]] std::size_t panels() const { return plane.size(); }
  /// Whether `panel` is no panel but a cut across its strip.
  [[nodiscard]] bool is_cut(std::size_t panel) const { return plane[panel] == kNoPlane; }
  /// First staircase point of strip `s`.
  [[nodiscard]] std::size_t first_point(std::size_t s) const { return first_panel[s] + s; }
};

/// Writes strips one after another along v, each from the wall to the ground.
class StripWriter {
 public:
  StripWriter();
  /// First point of the next strip's staircase.
  void start(double x, double z);
  void panel_to(double x, double z, PlaneId plane, int level = -1);
  /// Ends the strip.
  void close(StripKind kind, std::int32_t slice, double width_mm);
  /// A strip of `from` as it is there.
  void copy(const Strips& from, std::size_t s);
  [[nodiscard]] Strips take() { return std::move(strips_); }

 private:
  Strips strips_;
};

/// Places nearer than this are one place, mm: far below what paper or a machine can tell, far above
/// the rounding of the arithmetic that found them.
inline constexpr double kSamePlace_mm = 1e-9;

/// Gives numbers that differ by rounding only the same value: each becomes the least of its group,
/// a group reaching over less than `kSamePlace_mm`. Afterwards two of them are equal or at least
/// that far apart, and no larger than before. Order is kept, and zero stays what it is: the wall or
/// the ground. O(n log n).
///
/// Without it neighbours whose ends agree but for the last digit would be told apart by slits of
/// 1e-14 mm.
void unify_places(std::vector<double*>& places);

/// Gives panels of neighbouring strips that lie at exactly the same place and overlap one plane id,
/// the least of theirs. O(panels).
///
/// A plane's id says whose plane it is, and two slices may have planes at the same place: those of
/// two regions, two patches or two runs on a cylinder, and a bridge takes its planes from one side
/// alone. Left apart they would be cut from each other along a slit that is closed all around. Call
/// it after `unify_places`: then two planes are at one place or farther apart than rounding.
void unify_planes(Strips& strips);

}  // namespace popcut

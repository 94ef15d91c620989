// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/design/facets/seen_target.hpp"
#include "core/geometry/kite.hpp"

namespace popcut {

/// A plane that a point of the sheet can lie in: parallel to the wall at x = offset, or to the
/// ground at z = offset; the offset in steps of the grid, below 0 behind the card. A panel of a
/// kite has the plane of the stair's panel that it is the mirror image of (core/geometry/kite.hpp).
struct FacetPlane {
  bool upright{};
  int offset{};
  int kite{-1};  ///< index into `FacetPlanes::kites`; -1: none
  friend bool operator==(const FacetPlane&, const FacetPlane&) = default;
};

/// An index into `FacetPlanes`.
using Label = std::int16_t;
inline constexpr Label kNoLabel = -1;  ///< also a window: no paper
inline constexpr Label kWallLabel = 0;
inline constexpr Label kGroundLabel = 1;
inline constexpr int kMostLabels = 2000;
/// Whether it is the card's wall or ground.
[[nodiscard]] constexpr bool is_card(Label label) {
  return label == kWallLabel || label == kGroundLabel;
}

/// A kite in steps of the grid: Q on the level plane z = qz, E on the upright plane x = ex.
struct LabelKite {
  int qx{}, qz{}, ex{}, ez{};
  friend bool operator==(const LabelKite&, const LabelKite&) = default;

  [[nodiscard]] KiteSection section(double step_mm) const {
    return {{step_mm * qx, step_mm * qz}, {step_mm * ex, step_mm * ez}};
  }
};

/// The planes that labels stand for: wall and ground first, and two labels a kite last.
class FacetPlanes {
 public:
  /// @param upright, level  offsets in steps; 0 and doubles are left out
  /// @param carriers        planes that glued roofs hang on, among them
  FacetPlanes(const std::vector<int>& upright, const std::vector<int>& level,
              std::vector<LabelKite> kites = {}, std::vector<FacetPlane> carriers = {});

  [[nodiscard]] const std::vector<LabelKite>& kites() const { return kites_; }
  [[nodiscard]] bool is_of_kite(Label label) const { return (*this)[label].kite >= 0; }
  /// Whether the panel of a kite lies in the column that begins `across` steps from the spine.
  [[nodiscard]] bool is_at_kite(const FacetPlane& panel, int across) const;
  /// Whether a roof hangs on a plane: a kite, at which it ends, or a glued one.
  [[nodiscard]] bool carries_roof(Label label) const;
  [[nodiscard]] const std::vector<FacetPlane>& carriers() const { return carriers_; }

  [[nodiscard]] std::size_t size() const { return planes_.size(); }
  [[nodiscard]] const FacetPlane& operator[](Label label) const {
    return planes_[static_cast<std::size_t>(label)];
  }
  /// The label of a plane, or `kNoLabel`.
  [[nodiscard]] Label find(const FacetPlane& plane) const {
    if (plane.kite >= 0)
      return static_cast<Label>(first_of_kites_ + 2 * plane.kite + (plane.upright ? 0 : 1));
    const std::vector<Label>& table = plane.upright ? upright_ : level_;
    const int at = plane.offset - least_;
    return at < 0 || at >= static_cast<int>(table.size()) ? kNoLabel
                                                          : table[static_cast<std::size_t>(at)];
  }
  /// The plane that `label` meets in a fold `across` steps from the spine: x - z = across. Upright
  /// planes c and level ones d meet at c - d only. Panels of kites meet none so.
  [[nodiscard]] Label partner(Label label, int across) const {
    const FacetPlane& p = (*this)[label];
    if (p.kite >= 0) return kNoLabel;
    return find({!p.upright, p.upright ? p.offset - across : p.offset + across});
  }

  /// Whether two panels meet in a fold there, the second one farther from the wall's top.
  [[nodiscard]] bool meet(Label before, Label after, int across) const {
    if (is_of_kite(before) || is_of_kite(after)) return meet_at_kite(before, after, across);
    return partner(before, across) == after;
  }

 private:
  [[nodiscard]] bool meet_at_kite(Label before, Label after, int across) const;

  std::vector<FacetPlane> planes_;
  std::vector<LabelKite> kites_;
  std::vector<FacetPlane> carriers_;
  int first_of_kites_{};
  int least_{};
  std::vector<Label> upright_, level_;  ///< by offset from `least_`
};

/// Planes one step apart, as far as `planes` reach; `planes` themselves where those are too many.
[[nodiscard]] FacetPlanes every_step(const FacetPlanes& planes);

/// The sheet in cells: strips along v, and steps along u. The card's wall has `wall` steps.
struct FacetGrid {
  double step_mm{};
  int wall{};     ///< steps from the wall's top to the spine
  int columns{};  ///< steps from the wall's top to the ground's far edge
  double strip_mm{};
  int strips{};
  double v_from_mm{};  ///< where the first strip begins along the target

  /// Steps from the spine of the line before a column.
  [[nodiscard]] int across(int column) const { return column - wall; }
};

/// One label a cell, strip by strip: what a card of facets is.
struct LabelImage {
  FacetGrid grid;
  std::vector<Label> label;

  [[nodiscard]] std::span<Label> strip(int s) {
    return std::span(label).subspan(static_cast<std::size_t>(s) * width(), width());
  }
  [[nodiscard]] std::span<const Label> strip(int s) const {
    return std::span(label).subspan(static_cast<std::size_t>(s) * width(), width());
  }

 private:
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(grid.columns); }
};

/// A stretch of one label in a strip: columns `begin` to `end`.
struct LabelRun {
  int begin{}, end{};
  Label label{};
  /// It meets the run before it in a fold; false: in a cut, or there is none.
  bool folds_on{};
};

/// The runs of a strip, in order.
[[nodiscard]] std::vector<LabelRun> runs_of(std::span<const Label> strip, const FacetPlanes& planes,
                                            const FacetGrid& grid);

/// Planes worth trying for a target: one each `pitch` steps over what is seen, and where many
/// points that face wall or ground have one offset, that one.
///
/// @param most_x, most_z  largest offsets, in steps
/// @param inward          offsets below 0 too
/// @param kites           get their labels, and the planes that they hang on
/// @param carriers        planes that glued roofs hang on
[[nodiscard]] FacetPlanes planes_for(const SeenTarget& target, const FacetGrid& grid, int pitch,
                                     int most_x, int most_z, bool inward,
                                     const std::vector<LabelKite>& kites = {},
                                     const std::vector<FacetPlane>& carriers = {});

}  // namespace popcut

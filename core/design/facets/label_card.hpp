// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/design/facets/label_holding.hpp"
#include "core/design/facets/labelling.hpp"

namespace popcut {

/// New labels for a strip.
struct NewStrip {
  int strip{};
  std::vector<Label> labels;
};
using NewStrips = std::vector<NewStrip>;

[[nodiscard]] std::vector<Label> labels_of(const LabelImage& image, int strip);

/// What new labels cost more than those that are there, cuts to the strips beside them included.
/// The labelling is as before afterwards.
[[nodiscard]] double extra_cost(Labelling& labelling, const NewStrips& strips);

/// A labelling, its runs, and which of its patches are held.
struct LabelCard {
  Labelling& labelling;
  HoldRule rule{};
  StripRuns runs{};  ///< with a strip of plain card before the first and after the last one
  LabelHolding holding{};

  LabelCard(Labelling& labels, const HoldRule& hold_rule);

  [[nodiscard]] const LabelImage& image() const { return labelling.image(); }
  [[nodiscard]] const FacetPlanes& planes() const { return labelling.planes(); }
  [[nodiscard]] const FacetGrid& grid() const { return image().grid; }

  [[nodiscard]] const std::vector<LabelRun>& runs_of_strip(int s) const {
    return runs[static_cast<std::size_t>(s) + 1];
  }
  /// The first run of a strip among the runs of `holding.patches`.
  [[nodiscard]] std::uint32_t first_run(int s) const {
    return holding.patches.first_run[static_cast<std::size_t>(s) + 1];
  }
  [[nodiscard]] std::uint32_t patch_of(int s, std::size_t run) const {
    return holding.patches.patch[first_run(s) + run];
  }
  [[nodiscard]] bool is_loose(int s, std::size_t run) const {
    return holding.loose[patch_of(s, run)] != 0;
  }

  /// What would be held with new labels.
  [[nodiscard]] LabelHolding holding_with(const NewStrips& strips);
  /// Takes new labels.
  /// @param then  `holding_with` these strips
  void take(const NewStrips& strips, LabelHolding then);
  void take(const NewStrips& strips) { take(strips, holding_with(strips)); }
  /// Takes the labels of all strips.
  void take(const LabelImage& image);
};

/// A patch, such as one that is loose: its area in cells, and where it is.
struct LoosePatch {
  double area{};
  std::vector<LabelBan> cells;  ///< its stretches, by strip
};
/// The patches by number: all, or those that are loose.
[[nodiscard]] std::map<std::uint32_t, LoosePatch> patch_cells(const LabelCard& card,
                                                              bool only_loose);
/// The loose patches, smallest first.
[[nodiscard]] std::vector<LoosePatch> loose_patches(const LabelCard& card);

/// How loose a card is: the pins that would hold it, and a little for all that these move.
[[nodiscard]] double looseness(const LabelHolding& holding);

}  // namespace popcut

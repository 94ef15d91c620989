// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/lattice/lattice.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/strips/strips.hpp"

namespace popcut {

/// A slice as it is laid on the sheet. Most are slices of the design; a slice that stands alone
/// with three units or more is laid as two halves of the same curve.
struct LaidSlice {
  int slice{};        ///< of the design
  double s_mm{};      ///< place of its middle on the target
  double width_mm{};  ///< w: its strip is half as wide
};

/// A run of laid slices between plain cuts or margins, with its planes.
struct Run {
  int first{};  ///< of the laid slices
  int count{};
  Planes planes;
  /// Slices x (N + 1) marks of what an earlier attempt left loose, empty for none: planes to leave
  /// out of their slice, and levels to leave out of the connector after that slice.
  std::vector<std::uint8_t> loose_planes, loose_levels;
};

/// The frame around the strips. Without a card there are neither margins nor wall nor ground.
struct CardFrame {
  bool card{true};
  double wall_mm{};    ///< H; without a card the largest wall end
  double ground_mm{};  ///< D; without a card the largest ground end
  double margin_mm{};  ///< width of the margin strips; 0: none
};

/// A slice without structure between two runs, or beside the first or the last.
struct BlankSlice {
  int slice{};               ///< of the design
  double width_mm{};         ///< w
  std::size_t before_run{};  ///< the run that follows it
};

/// What the strips need beyond their planes.
struct StripOptions {
  CardFrame frame;
  double min_panel_mm{};
  /// Without a card: h and d of each laid slice, where its loose ends stop.
  std::vector<double> wall_ends, ground_ends;
  std::vector<BlankSlice> blanks;  ///< in the order of slices; in a card only
};

struct LaidStrips {
  Strips strips;
  std::vector<MergedPlace> merged;  ///< levels left out, with the reason
  std::vector<int> apart;           ///< laid slices after which no valid connector exists
};

/// Lays the runs as strips of monotone staircases (docs/geometry.md, section 4).
///
/// Where a step of a strip would be shorter than `min_panel_mm`, or go the wrong way, a level is
/// left out there. Slice strips come first, since a connector can
/// only use planes that its slices have. A blank slice is plain card of its full width and of what
/// the slices beside it leave to connectors.
[[nodiscard]] LaidStrips build_strips(const std::vector<LaidSlice>& laid, std::vector<Run> runs,
                                      StripOptions options);

/// The highest wall end and the farthest ground end of the runs, mm: what H and D must clear.
struct Reach {
  double wall_mm{};
  double ground_mm{};
};
[[nodiscard]] Reach reach_of(const std::vector<Run>& runs);

}  // namespace popcut

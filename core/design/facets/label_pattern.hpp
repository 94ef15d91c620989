// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/facets/labels.hpp"
#include "core/design/strips/pattern_builder.hpp"
#include "core/design/strips/strips.hpp"
#include "core/result.hpp"
#include "core/rigid/mobility.hpp"

namespace popcut {

/// The card around the labelled strips, mm.
struct FacetCardSize {
  double wall_mm{};
  double ground_mm{};
  double margin_mm{};
};

/// Labels as strips of panels between two margins: neighbouring strips with the same labels are
/// one. `strip_of[s]` is where strip s of the labels went.
struct LabelStrips {
  Strips strips;
  /// Panels that are cut from the strip before theirs, so that what is around a window is open.
  std::vector<std::uint32_t> parted;
  std::vector<std::uint32_t> strip_of;
};
[[nodiscard]] LabelStrips strips_of(const LabelImage& image, const FacetPlanes& planes,
                                    const FacetCardSize& card);

/// A labelling folded: its pattern and how it can move.
struct LabelPattern {
  LabelStrips strips;
  BuiltPattern built;
  rigid::Mobility motion;

  /// The face of run `run` of strip `s`, cuts not counted among runs.
  [[nodiscard]] std::int32_t face_of(int s, std::size_t run) const;
};

/// @retval Internal  a face surrounds others (`fill_enclosed` takes them away)
[[nodiscard]] Result<LabelPattern> pattern_of(const LabelImage& image, const FacetPlanes& planes,
                                              const FacetCardSize& card, double min_panel_mm);

/// Tells a finished pattern which of its faces are the panels of kites, and which way their folds
/// turn. A kite hangs on three folds between two planes, so it takes no freedom and gives none:
/// what is held is what a stair in its place would leave held. O(kites x (edges + lines)).
void mark_kites(LabelPattern& pattern, const FacetPlanes& planes, double step_mm);

/// Gives what lies inside of another patch, and touches nothing else, the label of that patch: it
/// could fall out or flap, and a face with a hole is not written. Whether anything changed.
bool fill_enclosed(LabelImage& image, const FacetPlanes& planes, double min_panel_mm);

/// Patches: connected cells of one label. Their number and the patch of each run, strip by strip.
struct LabelPatches {
  std::vector<std::uint32_t> first_run;  ///< strips + 1 offsets into `runs`
  std::vector<LabelRun> runs;
  std::vector<std::uint32_t> patch;  ///< one a run
  std::size_t count{};
};
using StripRuns = std::vector<std::vector<LabelRun>>;
/// The runs of all strips, with a strip of plain card before the first and after the last one.
[[nodiscard]] StripRuns strip_runs(const LabelImage& image, const FacetPlanes& planes);
[[nodiscard]] LabelPatches patches_of(const StripRuns& runs, const FacetGrid& grid,
                                      double min_panel_mm);
[[nodiscard]] LabelPatches patches_of(const LabelImage& image, const FacetPlanes& planes,
                                      double min_panel_mm);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/sim/trace.hpp"

namespace popcut {

/// What a trace is to be compared with, in the trace's own page coordinates.
struct Expected {
  LineWork drawing;   ///< folds whole, or `dashed`: then every line is drawn as it stands
  DashShape dashes;   ///< of the material; only for whole folds
  int cut_passes{1};  ///< how often a line is to be cut, for a drawing with whole folds
  int fold_passes{1};
  bool folds_whole{false};      ///< folds are pressed or cut half through along their whole length
  LineWork also_allowed;        ///< overcuts, lead-ins, tabs, marks, labels: may be drawn, need not
  double blade_offset_mm{};     ///< of a drag knife that the program turns itself; 0: none
  std::uint16_t blade_tools{};  ///< bit n: tool n is such a knife
};

/// What does not hold. Each failure names a line of the drawing or a stroke of the program (from 0)
/// and a place in mm.
struct Comparison {
  std::vector<std::string> failures;  ///< the first ones; empty if all holds
  std::uint64_t failed{};             ///< how many there are
  double expected_mm{};               ///< length of all expected lines, whole folds included
  double drawn_mm{};                  ///< length of all strokes
};

/// Compares what a cutter did with what it was to do.
///
/// It holds when every vertex of a stroke lies within half a machine unit (along each axis) of a
/// vertex of the drawing, or on a fold; when each place of each cut is covered as often as it is to
/// be (what is also lawful may cover it more often); when each whole fold is covered by dashes on
/// its line, none much longer than the material's and no gap longer than its gap, but where
/// clearance from cuts, ends and corners leaves no room for a dash; when nothing is drawn
/// elsewhere; and when nothing fell outside the window.
///
/// Where the program turns a drag knife itself it moves the blade's axis, and what counts is its
/// tip, which trails behind by `blade_offset_mm` (a tractrix, see core/plan/blade.hpp): the tip is
/// followed through all strokes, and must keep within half a unit and 0.05 mm of the drawing; its
/// vertices are not looked at.
///
/// O(n log n) in the number of segments as long as they do not pile up.
[[nodiscard]] Comparison compare(const Trace& trace, const Expected& expected);

/// `compare` as a check.
///
/// @retval CheckFailed  the first failures and their number
[[nodiscard]] Result<void> expect(const Trace& trace, const Expected& expected);

}  // namespace popcut

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

/// What a trace is compared with, in the trace's page coordinates.
struct Expected {
  LineWork drawing;   ///< with whole folds; or `dashed`: then every line is drawn as it is
  DashShape dashes;   ///< the material's; only for whole folds
  int cut_passes{1};  ///< how often to cut a line, for a drawing with whole folds
  int fold_passes{1}, score_passes{1}, draw_passes{1};
  std::vector<int> pen_passes{};  ///< in place of these, by `PenOperation::pen` - 1; 0: they hold
  bool folds_whole{false};        ///< folds are pressed or half cut along their whole length
  LineWork also_allowed;          ///< lines that may be drawn or not: overcuts, tabs, marks, ...
  double blade_offset_mm{};       ///< of a drag knife that the program turns; 0: none
  std::uint16_t blade_tools{};    ///< bit n is set if tool n is such a knife
};

/// The result of a comparison. Each failure names a line of the drawing or a stroke of the program
/// (from 0) and a place in mm.
struct Comparison {
  std::vector<std::string> failures;  ///< the first ones; empty if there are none
  std::uint64_t failed{};             ///< how many there are
  double expected_mm{};               ///< length of all expected lines, whole folds included
  double drawn_mm{};                  ///< length of all strokes
};

/// Compares what a cutter did with what it should have done. It requires that
/// - every vertex of a stroke lies within half a machine unit (along each axis) of a vertex of the
///   drawing, or on a fold;
/// - each place of each cut is covered as often as requested, or more often by `also_allowed`;
/// - each whole fold is covered by dashes on its line, none much longer than the material's, and
/// with
///   no longer gap than the material's, except where clearance from cuts, ends and corners leaves
///   no room for a dash;
/// - nothing is drawn elsewhere, and nothing fell outside the window.
///
/// If the program turns a drag knife itself, it moves the blade's axis. Then the comparison follows
/// the tip, which trails behind by `blade_offset_mm` (a tractrix, see core/plan/knife/blade.hpp).
/// The tip must stay within half a unit and 0.05 mm of the drawing; vertices are not compared.
///
/// O(n log n) in the number of segments unless many lie on each other.
[[nodiscard]] Comparison compare(const Trace& trace, const Expected& expected);

/// `compare` as a check.
///
/// @retval CheckFailed  the first failures and their number
[[nodiscard]] Result<void> expect(const Trace& trace, const Expected& expected);

}  // namespace popcut

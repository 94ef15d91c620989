// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// How a flat sheet was opened.
struct Trajectory : OpeningFigures {
  std::vector<Pose> poses;  ///< one per requested opening angle that was reached, in order
  std::string guess;        ///< source of the first guess
  std::string stopped;      ///< why it stopped; empty if it reached the last angle
  std::size_t reversed{};   ///< folds that turn against their assignment
  bool spent{};             ///< the sheet is too large to try everything
  std::vector<std::string> notes;
};

/// Opens a flat sheet by continuation, with rigid panels and closed hinges.
///
/// The opening angle psi is pi minus the fold angle at the driving line: the longest hinge line
/// (all folds between the same two panels in one line; on a card this is the spine, from margin to
/// margin). A valley is preferred among lines of equal length. If the motion along that line ends
/// early, the next longest lines are tried, and the one that goes farthest is kept.
///
/// The flat state is a branch point: it has more first-order motions than motions. It is left by a
/// finite step in the direction that the assignments give: signs, with the half-angle tangents of
/// `fold_angle_deg` as speeds, else equal speeds, else a few random ones. Panels are folded by that
/// guess, pulled onto closed hinges with less and less weight on the guess, then corrected with the
/// driving angle alone. The first branch on which every mountain and valley turns its way is taken.
/// From there psi goes on in steps: half-angle tangents are extrapolated (exact for flat-foldable
/// vertices of four folds) and Gauss-Newton corrects. A step is halved if the correction fails or
/// lands far from the extrapolation. With more than one degree of freedom, the correction is the
/// least motion from the extrapolated pose.
///
/// @param psi_rad   opening angles to stop at, descending, between 0 and pi (both excluded)
/// @param slack_mm  gaps up to this size count as closed: how exact the drawing is
[[nodiscard]] Trajectory open_sheet(const FoldModel& file, const Sheet& sheet,
                                    std::span<const double> psi_rad, double slack_mm);

/// The driving line that `open_sheet` tries first, as one of its folds (an index into
/// `Sheet::hinges`). None if no two panels turn against each other.
[[nodiscard]] std::optional<std::uint32_t> driving_hinge(const FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify

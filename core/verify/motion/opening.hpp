// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// How a flat sheet was opened.
struct Opening {
  std::vector<Pose> poses;      ///< one an opening angle that was reached, in the order asked for
  std::uint32_t driver_edge{};  ///< a fold of the driving line
  double driver_length_mm{};    ///< of the whole driving line
  double gap_mm{};              ///< largest gap that is left in any of the poses
  double reached_psi_rad{};     ///< smallest opening angle that was reached, pi for none
  std::size_t steps{}, iterations{};  ///< of continuation; Gauss-Newton, all together
  std::string guess;                  ///< what the way out of the flat state was guessed from
  std::string stopped;                ///< why it went no further; empty when it reached the last
  std::size_t reversed{};  ///< folds that turn against their assignment on the branch taken
  bool spent{};            ///< the sheet is so large that not all was tried
  std::vector<std::string> notes;
};

/// Opens a flat sheet by continuation: rigid panels, closed hinges.
///
/// The opening angle psi is pi less the fold angle at the driving line: the longest hinge line (all
/// folds between the same two panels in one line; on a card that is the spine, which reaches from
/// margin to margin), a valley rather than a mountain where two are equally long; where the motion
/// along it ends early, the next longest ones are tried and the one that goes farthest is kept.
///
/// The flat state is a branch point: its first-order motions are more than its motions. It is left
/// by a finite step in the direction that the assignments give (signs; the half-angle tangents of
/// `fold_angle_deg` as speeds, else equal ones, else a few random ones): panels are folded by that
/// guess, drawn onto the closed hinges while leaning toward it less and less, then corrected with
/// the driving angle alone. The first branch on which every mountain and valley turns its way is
/// taken. From there psi goes on in steps: half-angle tangents are extrapolated (exact for vertices
/// of four folds that fold flat), Gauss-Newton corrects; a step is halved when the correction fails
/// or lands far from what was extrapolated. Where there is more than one freedom the correction is
/// the least motion from the extrapolated pose.
///
/// @param psi_rad   opening angles to stop at, descending, within 0 and pi (both excluded)
/// @param slack_mm  gaps up to this size count as closed: how exact the drawing is
[[nodiscard]] Opening open_sheet(const FoldModel& file, const Sheet& sheet,
                                 std::span<const double> psi_rad, double slack_mm);

/// The driving line that `open_sheet` tries first, by one of its folds (an index into
/// `Sheet::hinges`); nothing where no two panels turn against each other.
[[nodiscard]] std::optional<std::uint32_t> driving_hinge(const FoldModel& file, const Sheet& sheet);

}  // namespace popcut::verify

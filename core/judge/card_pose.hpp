// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/compare/depth_image.hpp"
#include "core/compare/placement.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/sheet/fold_model.hpp"

namespace popcut::judge {

/// A pattern as it stands opened, read and opened by the code of the verifier.
struct CardPose {
  std::vector<float> triangles;  ///< nine numbers each, (x, v, z) in mm
  likeness::Corner corner;       ///< ground and wall beside the spine
  double psi_rad{};              ///< opening angle of the pose
  /// Where the model stands that it was designed from, if the file says so and shows that pose.
  std::optional<likeness::ModelPlacement> model;
  std::size_t folds{};         ///< lines about which two rigid panels turn
  double smallest_joint_mm{};  ///< the least length along which two panels hold together; 0: none
  std::size_t pieces{};        ///< of paper
  std::vector<std::string> notes;
  verify::FoldModel file;  ///< the sheet, with the pose as its only one
};

/// Opens the pattern of a FOLD file.
///
/// The pose is the frame at `psi_rad`. Without it: the frame at the angle that the file says it is
/// designed for (pi/2 where it does not) if it gives opening angles, else the first frame that is
/// neither flat nor shut. A pattern that has no such frame is opened by `pattern_from_fold` or
/// `open_flat_sheet`. Frames without an opening angle can stand anywhere in space: they are carried
/// so that the longest fold line is the spine, with the ground at its right.
///
/// @param psi_rad  more than 0 (shut) and less than pi (flat), or none
/// @retval Malformed   not a FOLD file
/// @retval OutOfRange  no faces, no folds, a pose that stretches the sheet, or a sheet that does
/// not
///                     open; place is within the text
[[nodiscard]] Result<CardPose> open_card(std::string_view fold_text, std::optional<double> psi_rad,
                                         const Progress& progress = {});

}  // namespace popcut::judge

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/sheet/check.hpp"

namespace popcut {

namespace verify {
struct FoldModel;
}

/// Options of `verify_fold`.
struct VerifyOptions {
  std::optional<std::size_t> degrees_of_freedom{};  ///< required number; none: only 0 fails
  /// Text of a design spec: measures the distance from its target.
  std::optional<std::string> target_spec{};
  /// For a drawing without faces on a page (x = v, y = u): reports places as x and y.
  bool page{false};
  /// Contents of the files that the spec names (`target_files_of`), by those names.
  std::map<std::string, std::string> target_files{};
  /// O(faces log faces) for rectangular units: their one freedom is proven by propagation where
  /// that decides, freedoms are counted only where a number is demanded, and the motion of other
  /// sheets is looked at in the poses of the file alone.
  bool quick{false};
  /// Names places by their coordinates on the sheet, for a pattern that has no file.
  bool name_coordinates{false};
  Progress progress{};  ///< told before each check
};

/// A panel that moves by more than 1 mm in paper.
struct LoosePanelFigure {
  std::uint32_t panel{};
  double moves_mm{};
};

/// How far panels move where folds lie 0.1 mm off their lines (docs/hands.md, section 1): root mean
/// square of the farthest point of each, wall and ground held.
struct PaperWobble {
  double largest_mm{};
  double mean_mm{};                     ///< over the area
  std::vector<LoosePanelFigure> loose;  ///< the loosest first
};

/// What a pattern is and whether it is sound. Figures that could not be measured stay zero; their
/// check says why.
struct VerifyReport : Tiling {
  std::vector<VerifyCheck> checks;
  std::vector<std::string> notes;

  std::size_t vertices{}, edges{};
  std::size_t fold_faces{};  ///< faces as the file lists them
  std::size_t faces{};       ///< rigid faces: faces joined over flat creases count once
  std::size_t hinges{};      ///< lines about which rigid faces turn
  std::size_t pieces{};
  std::size_t poses{};  ///< poses measured, from frames or from opening
  std::optional<OpeningFigures> opening;

  double isometry_mm{};     ///< largest change of a length, over all poses
  double hinge_gap_mm{};    ///< largest gap in a fold, over all poses
  double fold_angle_deg{};  ///< largest deviation of a listed fold angle

  std::optional<std::size_t> degrees_of_freedom;
  double pose_psi_rad{};  ///< opening angle of the pose of the count; 0: unknown
  double largest_zero{};  ///< the singular values on both sides of the gap
  double smallest_nonzero{};
  double gap{};
  std::vector<double> smallest_singular_values;

  std::string crossing_method;        ///< "exact", "sampled", or empty: not checked
  std::optional<PaperWobble> wobble;  ///< none: not measured
  std::optional<TargetDistance> target_inner, target_all;

  [[nodiscard]] bool ok() const;
  /// How many things fail, over all checks.
  [[nodiscard]] std::size_t failed() const;
};

/// Recomputes from a FOLD file alone what a pattern must satisfy (docs/geometry.md, section 4):
/// one connected piece, faces that tile the sheet, no doubled or crossing lines, isometric and
/// closed in every pose that the file holds, fold angles and assignments that agree with the poses,
/// the degrees of freedom in a pose that is neither flat nor shut, and no face through another.
/// A file without such a pose is opened by the rigid-panel solver (core/verify/motion/opening.hpp)
/// and judged in the poses that it goes through; one without faces gets those that its lines
/// enclose. Shares no code with what generates patterns, so that a fault there cannot hide here.
/// What it does share knows nothing of patterns and has tests of its own: core/geometry (vectors,
/// triangulation, disjoint sets, indexes) and core/text (the arrays of a FOLD file, as they stand
/// in its JSON). Its reader of FOLD files (`verify::FoldModel`), its targets and its solver are its
/// own.
///
/// @retval Malformed, OutOfRange  the file cannot be read or has no sheet; the same for the target
///         spec
[[nodiscard]] Result<VerifyReport> verify_fold(std::string_view text,
                                               const VerifyOptions& options = {});

/// The same for a file that has been read, or that a pattern would be written as.
[[nodiscard]] Result<VerifyReport> verify_model(verify::FoldModel model,
                                                const VerifyOptions& options = {});

/// The mesh and grid files that the spec's surfaces name (its own and its patches'), each once.
[[nodiscard]] std::vector<std::string> target_files_of(std::string_view spec_json);

/// The report as text: one line per check, with its first failures and a count of the others.
[[nodiscard]] std::string verify_text(const VerifyReport& report);

/// The report as a JSON document; lengths in mm, angles in the unit of their name.
[[nodiscard]] std::string verify_json(const VerifyReport& report);

}  // namespace popcut

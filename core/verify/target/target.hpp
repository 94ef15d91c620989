// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/target/target_surface.hpp"

namespace popcut {
struct DesignSpec;
}  // namespace popcut

namespace popcut::verify {

/// A slice of the spec: what decides its place on the sheet.
struct TargetSlice {
  double width_mm{};
  int units{};
  bool cut_after{};  ///< no connector follows: a plain cut or a bridge
  double s_mm{};     ///< of its middle, from the middle of the first slice
};

/// Sets `s_mm` of all slices from their widths.
void place_slices(std::vector<TargetSlice>& slices);

/// A stretch of the slices that was designed by itself: one patch, or all of a spec without them.
struct TargetPatch {
  std::size_t first_slice{};
  double margin_mm{};  ///< of its card
};

/// A target surface and its slices (docs/geometry.md, section 3).
struct Target {
  std::unique_ptr<TargetSurface> surface;
  std::vector<TargetSlice> slices;   ///< empty: the design chose the widths
  std::vector<TargetPatch> patches;  ///< at least one
  TargetWall wall;                   ///< where the distances are measured
  double angle_deg{90.0};            ///< of the wall
  int chosen_units{};                ///< units of all slices, if the design chose the widths; or 0

  /// The slices of the patches from `first` to `last`.
  [[nodiscard]] std::span<const TargetSlice> slices_of(std::size_t first, std::size_t last) const;
};

/// Contents of the files that a spec names, by the name that it gives.
using TargetFiles = std::map<std::string, std::string>;

/// Makes from a design spec what the distance needs: the surface (of any kind, including regions,
/// composites and patches), its placement, the slices with their widths, and the margin of the
/// card. `files` has the contents of `target_files_of`.
///
/// @retval Malformed   facets, or an expression or file that cannot be read
/// @retval OutOfRange  a kind of surface that is not measured; widths that are chosen in patches
[[nodiscard]] Result<Target> read_target(const DesignSpec& spec, const TargetFiles& files = {});
/// The same of the text of a spec; also the errors of `parse_design_spec`.
[[nodiscard]] Result<Target> read_target(std::string_view spec_json, const TargetFiles& files = {});

/// A slice or connector: its strip on the sheet, and the place of its middle on the target.
struct TargetStation {
  double begin_mm{}, end_mm{};
  double s_mm{};
  double reach_mm{};  ///< to both sides of `s_mm`: where its curve is from if the target ends there
};

/// All strips of a pattern that belong to the target, along the spine.
struct TargetStations {
  std::vector<TargetStation> slices;  ///< a slice without neighbours occurs twice, as two halves
  /// A connector (or the slice itself if it has none) and the slices beside it.
  struct Connector {
    TargetStation at;
    std::size_t left{}, right{};
  };
  std::vector<Connector> connectors;
  std::size_t first_patch{}, last_patch{};  ///< the patches that the pattern shows
};

/// Finds the strips on the sheet: the way to lay the spec's slices, with connectors, plain cuts and
/// bridges, that agrees best with the borders that the pattern shows. Also finds the widths if the
/// design chose them. A pattern can be some of a spec's patches; where several runs of patches fit
/// equally well, all are returned.
///
/// @retval CheckFailed  the sheet's strips are not those of the spec
[[nodiscard]] Result<std::vector<TargetStations>> find_stations(const FoldModel& file,
                                                                const Pose& pose,
                                                                const Target& target);

/// Measures the fold vertices, where a connector's valley folds cross it: the inner ones, and all
/// of them including the ends at wall and ground. `check` fails if the pattern does not show them.
/// If several runs of patches fit the pattern, the nearest one counts.
/// @return none if the pattern allows no measurement at all
[[nodiscard]] std::optional<TargetDistances> measure_target(const FoldModel& file,
                                                            const Target& target,
                                                            VerifyCheck& check);

/// Inverts the pose: the point (X, Z) from (X + Z cos psi, v, Z sin psi).
struct FoldVertex {
  double x{}, z{};
};
[[nodiscard]] FoldVertex unposed(Vec3 p, double psi_rad);

}  // namespace popcut::verify

// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/target/target_surface.hpp"

namespace popcut::verify {

/// A slice of the spec: what decides its place on the sheet.
struct TargetSlice {
  double width_mm{};
  int units{};
  bool cut_after{};  ///< a plain cut follows instead of a connector
};

/// A target surface and its slices (docs/geometry.md, section 3).
struct Target {
  std::unique_ptr<TargetSurface> surface;
  std::vector<TargetSlice> slices;  ///< empty: the design chose the widths
  int chosen_units{};               ///< units of all slices, if the design chose the widths
  double margin_mm{};
};

/// Reads from a design spec what the distance needs: the surface (of any kind, including regions
/// and composites), its placement, the slices with their widths, and `card`. Ignores other members.
/// `file_bytes` is the content of the file named by `target_file_of`, if there is one.
///
/// @retval Malformed   not JSON, a wrong type, or an expression or file that cannot be read
/// @retval OutOfRange  a number that is not valid, or an unknown kind of surface
[[nodiscard]] Result<Target> read_target(std::string_view spec_json,
                                         const std::string& file_bytes = {});

/// A slice or connector: its strip on the sheet, and the place of its middle on the target.
struct TargetStation {
  double begin_mm{}, end_mm{};
  double s_mm{};
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
};

/// Finds the strips on the sheet: by the spec's widths if the sheet is as wide as they say, else
/// with the plain cuts that the pattern shows. Also finds the widths if the design chose them.
///
/// @retval CheckFailed  the sheet's strips are not those of the spec
[[nodiscard]] Result<TargetStations> find_stations(const FoldModel& file, const Pose& pose,
                                                   const Target& target);

/// Measures the fold vertices, where a connector's valley folds cross it: the inner ones, and all
/// of them including the ends at wall and ground. `check` fails if the pattern does not show them.
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

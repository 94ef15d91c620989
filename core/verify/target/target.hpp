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
#include "core/verify/target/target_distance.hpp"

namespace popcut::verify {

/// A slice of the spec, as far as its place on the sheet depends on it.
struct TargetSlice {
  double width_mm{};
  int units{};
  bool cut_after{};  ///< a plain cut follows, no connector
};

/// A target surface and its slices (docs/geometry.md, section 3).
struct Target {
  std::unique_ptr<TargetSurface> surface;
  std::vector<TargetSlice> slices;  ///< empty: the widths were chosen by the design
  int chosen_units{};               ///< of all slices, where the widths were chosen
  double margin_mm{};
};

/// Reads from a design spec what the distance needs: the surface (every kind, regions and composite
/// too), its placement, the slices with their widths and `card`. Other members are not looked at.
/// `file_bytes` are those of `target_file_of`, where it names one.
///
/// @retval Malformed   not JSON, a wrong type, an expression or a file that cannot be read
/// @retval OutOfRange  a number that is not lawful, a kind of surface that is not known
[[nodiscard]] Result<Target> read_target(std::string_view spec_json,
                                         const std::string& file_bytes = {});

/// A slice or connector: its strip on the sheet and the place of its middle on the target.
struct TargetStation {
  double begin_mm{}, end_mm{};
  double s_mm{};
};

/// All strips of a pattern that belong to the target, along the spine.
struct TargetStations {
  std::vector<TargetStation> slices;  ///< a slice that stands alone is there twice, as two halves
  /// A connector, or the slice itself where it has none, and the slices beside it.
  struct Connector {
    TargetStation at;
    std::size_t left{}, right{};
  };
  std::vector<Connector> connectors;
};

/// Finds the strips on the sheet: from the spec's widths where the sheet is as wide as they say,
/// else with the plain cuts that the pattern shows; and the widths too where the design chose them.
///
/// @retval CheckFailed  the sheet's strips are not those of the spec
[[nodiscard]] Result<TargetStations> find_stations(const FoldFile& file, const Pose& pose,
                                                   const Target& target);

/// Measures the fold vertices, where a connector's valley folds cross it: the inner ones, and all
/// with the ends at wall and ground. `check` fails when the pattern does not show them; nothing is
/// returned where not even that can be looked for.
[[nodiscard]] std::optional<TargetDistances> measure_target(const FoldFile& file,
                                                            const Target& target,
                                                            VerifyCheck& check);

/// Undoes the pose: the point (X, Z) from (X + Z cos psi, v, Z sin psi).
struct FoldVertex {
  double x{}, z{};
};
[[nodiscard]] FoldVertex unposed(Vec3 p, double psi_rad);

}  // namespace popcut::verify

// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/verify/fold_model.hpp"
#include "core/verify/verify.hpp"

namespace popcut::verify {

/// A target surface, cut by the planes y = const.
class TargetSurface {
 public:
  virtual ~TargetSurface() = default;
  /// Distance of the point (x, z) from the target's curve at `s_mm`, within that plane; negative
  /// where the target has no curve there. All in mm.
  [[nodiscard]] virtual double distance_mm(double s_mm, double x_mm, double z_mm) const = 0;
};

/// A target surface and where its slices lie on the sheet (design reference, section 3).
struct Target {
  std::unique_ptr<TargetSurface> surface;
  std::vector<double> connector_v_mm;  ///< middles of the connector strips on the sheet
  std::vector<double> connector_s_mm;  ///< the same places on the target
};

/// Reads from a design spec what the distance needs: `surface` (revolution or profile), `scale_mm`,
/// `slices`, `widths_mm` and `card.margin_mm`. Other members are not looked at.
///
/// @retval Malformed   not JSON, a wrong type, an expression that cannot be read
/// @retval OutOfRange  a kind of target that verify does not measure yet
[[nodiscard]] Result<Target> read_target(std::string_view spec_json);

/// Measures the fold vertices, where the middle of a connector meets a valley fold: the inner ones,
/// and all with the ends at wall and ground. Fills `target_inner` and `target_all` of the report;
/// `check` fails when the pattern does not show them.
void measure_target(const FoldFile& file, const Target& target, VerifyReport& report,
                    VerifyCheck& check);

}  // namespace popcut::verify

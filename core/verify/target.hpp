// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/verify/fold_model.hpp"
#include "core/verify/target_surface.hpp"
#include "core/verify/verify.hpp"

namespace popcut::verify {

/// A slice or connector: the middle of its strip on the sheet and the same place on the target.
struct TargetStation {
  double v_mm{};
  double s_mm{};
};

/// A target surface and where its slices lie on the sheet (design reference, section 3).
struct Target {
  std::unique_ptr<TargetSurface> surface;
  std::vector<TargetStation> slices;
  std::vector<TargetStation> connectors;  ///< one between two slices; none where slices are boxes
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

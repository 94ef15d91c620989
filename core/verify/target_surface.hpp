// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "core/result.hpp"

namespace popcut::verify {

/// Where a target's curve meets the wall (height) and the ground (offset), in mm.
struct CurveEnds {
  double wall{};
  double ground{};
};

/// A target surface, cut by the planes y = const. All in mm.
class TargetSurface {
 public:
  virtual ~TargetSurface() = default;
  /// Distance of the point (x, z) from the target's curve at `s_mm`, within that plane; negative
  /// where the target has no curve there.
  [[nodiscard]] virtual double distance_mm(double s_mm, double x_mm, double z_mm) const = 0;
  [[nodiscard]] virtual CurveEnds ends_mm(double s_mm) const = 0;
};

enum class TargetKind {
  Revolution,  ///< quarter circles about the spine; the expression of y is their radius
  Profile,     ///< the expression of x and y is the height z
};

/// @retval Malformed  the expression cannot be read
[[nodiscard]] Result<std::unique_ptr<TargetSurface>> make_surface(TargetKind kind,
                                                                  const std::string& expression,
                                                                  double scale_mm);

}  // namespace popcut::verify

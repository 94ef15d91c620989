// SPDX-License-Identifier: MIT
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/design/target/expression.hpp"
#include "core/design/target/surface_kinds.hpp"

namespace popcut {
namespace {

Result<SurfaceSlice> slice(const Expression& radius, double length, double scale_mm, double s_mm,
                           double y) {
  const double r_mm = scale_mm * radius(y, length);
  const std::string place = fmt::format("/surface/radius at s = {:.6g} mm", s_mm);
  if (!std::isfinite(r_mm))
    return fail(
        ErrorKind::OutOfRange, place,
        fmt::format("the radius is not a number at y = {:.6g}; it must be finite and positive "
                    "for every slice: fewer or narrower slices, or another radius",
                    y),
        ErrorReason::Misplaced);
  if (r_mm <= 0.0)
    return fail(
        ErrorKind::OutOfRange, place,
        fmt::format("the radius is {:.6g} mm at y = {:.6g}; it must be positive for every slice",
                    r_mm, y),
        ErrorReason::Misplaced);
  return SurfaceSlice{SliceCurve(r_mm, r_mm), {}};
}

}  // namespace

Result<Surface> surface_revolution(const RevolutionSpec& spec, const TargetPlacement& placement,
                                   FitMode fit) {
  std::vector<std::string> variables{"y"};
  if (spec.length) variables.emplace_back("L");
  const double length = spec.length.value_or(0.0);
  auto radius = Expression::parse(spec.radius, variables);
  if (!radius) return tl::unexpected(within("/surface/radius", radius.error()));
  // std::function needs a copyable callable, an Expression is not one.
  auto shared = std::make_shared<Expression>(std::move(*radius));
  if (!stays_upright(placement))
    return surface_of_solid(
        [shared, length](double x, double y, double z) {
          const double r = (*shared)(y, length);
          return r > 0.0 ? x * x + z * z - r * r : 1.0;
        },
        placement, fit, "revolution");
  return Surface([shared, placement, length](double s_mm) {
    const double y = (s_mm - placement.translate_mm[1]) / placement.scale_mm;
    return slice(*shared, length, placement.scale_mm, s_mm, y);
  });
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut::verify {

/// Where a target's curve meets the wall (height) and the ground (offset), in mm; negative where it
/// does not.
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

/// How a surface stands in the corner: its point q is at `R_z R_y R_x (scale_mm q) + translate_mm`.
struct TargetPlacement {
  double scale_mm{1.0};
  std::array<double, 3> rotate_deg{};
  std::array<double, 3> translate_mm{};

  /// No turn, and no shift but along the spine.
  [[nodiscard]] bool upright() const;
};

/// The placement as a map.
class PlacedFrame {
 public:
  explicit PlacedFrame(const TargetPlacement& placement);
  [[nodiscard]] std::array<double, 3> to_corner(const std::array<double, 3>& q) const;
  [[nodiscard]] std::array<double, 3> to_surface(const std::array<double, 3>& p) const;

 private:
  std::array<std::array<double, 3>, 3> turn_{};
  double scale_;
  std::array<double, 3> shift_;
};

/// A formula of x, y and z, in units of the surface.
using TargetFormula = std::function<double(double, double, double)>;

/// Reads an expression of x, y, z and (where there is one) the region's length L.
///
/// @retval Malformed  it cannot be read
[[nodiscard]] Result<TargetFormula> read_formula(const std::string& expression,
                                                 std::optional<double> length);

/// Quarter circles about the spine, `radius(0, y, 0)`.
[[nodiscard]] std::unique_ptr<TargetSurface> revolution_target(TargetFormula radius,
                                                               const TargetPlacement& placement);
/// A profile: the height is `z(x, y, 0)`.
[[nodiscard]] std::unique_ptr<TargetSurface> profile_target(TargetFormula z,
                                                            const TargetPlacement& placement);
/// The border of what is inside, `f(x, y, z) < 0`; not a number is outside. Found by signs alone:
/// the nearest place where the sign changes, on growing circles, then narrowed along and across.
[[nodiscard]] std::unique_ptr<TargetSurface> solid_target(TargetFormula f,
                                                          const TargetPlacement& placement);

/// Triangles as a file has them: nine coordinates each.
struct TargetTriangles {
  std::vector<float> corners;
  [[nodiscard]] std::size_t size() const { return corners.size() / 9; }
};

/// Reads binary and text STL, and OBJ (`name` tells which).
///
/// @retval Malformed   broken or without faces
/// @retval OutOfRange  more than ten million triangles, a coordinate that is not finite
[[nodiscard]] Result<TargetTriangles> read_target_mesh(const std::string& name,
                                                       const std::string& bytes);
/// Reads heights over a grid from CSV (x values in the first row, y values in the first column);
/// each cell is two triangles that share the diagonal from the least to the largest x and y.
///
/// @retval Malformed  a cell that is no number, a row of another length, x or y that do not grow
[[nodiscard]] Result<TargetTriangles> read_target_grid(const std::string& name,
                                                       const std::string& bytes);

/// The sections of triangles: a plane's nearest piece counts, whether it is seen from outside or
/// not. Ends are where the section reaches wall and ground.
[[nodiscard]] std::unique_ptr<TargetSurface> mesh_target(TargetTriangles triangles,
                                                         const TargetPlacement& placement);

/// A stretch of the spine with a surface of its own, told places from `origin_mm`.
struct TargetStretch {
  double begin_mm{};  ///< it holds from here on
  double origin_mm{};
  std::shared_ptr<const TargetSurface> surface;
};
/// Stretch by stretch along the spine; `stretches` rise.
[[nodiscard]] std::unique_ptr<TargetSurface> stretched_target(std::vector<TargetStretch> stretches);

}  // namespace popcut::verify

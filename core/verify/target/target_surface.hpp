// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/triangle_mesh.hpp"
#include "core/result.hpp"

namespace popcut::verify {

/// Where a target's curve meets the wall and the ground, in mm from the spine; negative if it does
/// not.
struct CurveEnds {
  double wall{};
  double ground{};
};

/// The wall, as it stands at the angle that a design is made for: a point on it is at
/// `a (cosine, sine)` in (x, z). The ground is z = 0.
struct TargetWall {
  double cosine{0.0}, sine{1.0};

  [[nodiscard]] static TargetWall at_deg(double angle_deg);
  /// How far a point is from the wall along the ground; negative behind it.
  [[nodiscard]] double ahead(double x, double z) const { return x - z * cosine / sine; }
};

/// Where triangles of a surface are asked for: a stretch of the spine, and how far from wall and
/// ground a solid is looked for at least. In mm.
struct TargetReach {
  double begin_mm{}, end_mm{};
  double x_mm{}, z_mm{};
};

/// A target surface, cut by the planes y = const. All in mm.
class TargetSurface {
 public:
  virtual ~TargetSurface() = default;
  /// Distance of the point (x, z) from the target's curve in the plane at `s_mm`; negative if the
  /// target has no curve there.
  [[nodiscard]] virtual double distance_mm(double s_mm, double x_mm, double z_mm) const = 0;
  [[nodiscard]] virtual CurveEnds ends_mm(double s_mm) const = 0;
  /// Appends the surface as triangles, in corner coordinates: (x, s, z). Formulas and drawn curves
  /// over the stretch of the spine that is asked for, as far as they are there; the triangles of a
  /// file all. Wall, ground and the ends of the stretch are no part of the surface.
  virtual void add_triangles(const TargetReach& reach, TriangleMesh& out) const = 0;
};

/// Points of a section from wall to ground, equally many at each place along the spine; none where
/// there is no section.
using SectionPoints = std::function<std::vector<std::array<double, 2>>(double s_mm)>;
/// Appends the surface through sections of the stretch: 160 of them, and one more where they begin
/// or end within it.
void add_sections(const TargetReach& reach, const SectionPoints& section, TriangleMesh& out);

/// How a surface is placed in the corner: its point q is at `R_z R_y R_x (scale_mm q) +
/// translate_mm`.
struct TargetPlacement {
  double scale_mm{1.0};
  std::array<double, 3> rotate_deg{};
  std::array<double, 3> translate_mm{};
  TargetWall wall{};

  /// Not turned, and shifted only along the spine.
  [[nodiscard]] bool upright() const;
};

/// The placement as a map between surface and corner coordinates.
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

/// Parses an expression of x, y, z and (if given) the region's length L.
///
/// @retval Malformed  it cannot be parsed
[[nodiscard]] Result<TargetFormula> read_formula(const std::string& expression,
                                                 std::optional<double> length);

/// Points of a curve that is drawn: place and value, or x and z.
using TargetPoints = std::vector<std::array<double, 2>>;
/// The value at y of the smooth curve through points (y, value), which turns only where they do;
/// NaN outside of them.
[[nodiscard]] TargetFormula formula_through(const TargetPoints& points);

/// A section that is drawn: points (x, z) that fall from the wall to the ground.
struct DrawnStation {
  double y{};
  TargetPoints curve;
};
/// The surface through sections, by growing y, with equally many points; a single one reaches along
/// the whole spine.
[[nodiscard]] std::unique_ptr<TargetSurface> loft_target(std::vector<DrawnStation> stations,
                                                         const TargetPlacement& placement);

/// Circles about the spine from ground to wall, of radius `radius(0, y, 0)`.
[[nodiscard]] std::unique_ptr<TargetSurface> revolution_target(TargetFormula radius,
                                                               const TargetPlacement& placement);
/// A profile: the height is `z(x, y, 0)`.
[[nodiscard]] std::unique_ptr<TargetSurface> profile_target(TargetFormula z,
                                                            const TargetPlacement& placement);
/// The border of the solid `f(x, y, z) < 0`; NaN is outside. Found by signs alone: searches growing
/// circles for the nearest place where the sign changes, then narrows along and across.
[[nodiscard]] std::unique_ptr<TargetSurface> solid_target(TargetFormula f,
                                                          const TargetPlacement& placement);

/// The sections of triangles: the nearest piece in a plane counts, whether or not it is visible
/// from outside. The ends are where the section reaches wall and ground.
[[nodiscard]] std::unique_ptr<TargetSurface> mesh_target(TriangleMesh triangles,
                                                         const TargetPlacement& placement);

/// A stretch of the spine with its own surface, whose positions count from `origin_mm`.
struct TargetStretch {
  double begin_mm{};  ///< where the stretch begins
  double origin_mm{};
  std::shared_ptr<const TargetSurface> surface;
};
/// Surfaces of stretches along the spine; `stretches` must be sorted by `begin_mm`.
[[nodiscard]] std::unique_ptr<TargetSurface> stretched_target(std::vector<TargetStretch> stretches);

}  // namespace popcut::verify

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/design/spline/loft.hpp"

namespace popcut {

/// Points of a curve, in units of the surface: place and value, or x and z.
using CurvePoints = std::vector<std::array<double, 2>>;
/// A formula, or a smooth curve through points (`MonotoneSpline`).
using FormulaOrPoints = std::variant<std::string, CurvePoints>;

/// Circles about the spine from ground to wall: x^2 + z^2 = radius(y)^2, in units of the surface.
struct RevolutionSpec {
  FormulaOrPoints radius;          ///< expression of y, and of L where there is a length; or (y, r)
  std::optional<double> length{};  ///< L, length of the region that it belongs to
};

/// A profile z(x, y) that falls from (0, h) to (d, 0) for each y, in units of the surface.
struct ProfileSpec {
  FormulaOrPoints z;  ///< expression of x and y; or (x, z) of a curve that is the same for each y
};

/// A surface through falling curves at places along the spine (`Loft`), in units of the surface.
struct LoftSpec {
  std::vector<LoftStation> stations;
};

/// A solid: inside where f(x, y, z) < 0, outside where it is larger or not a number.
struct ImplicitSpec {
  std::string f;  ///< expression of x, y and z
};

/// Heights over a grid of x and y; between them the surface is linear on triangles.
struct GridSpec {
  std::string file;  ///< name of a CSV file (`read_height_grid`)
};

/// Triangles of a file.
struct MeshSpec {
  std::string file;  ///< name of an STL, OBJ or glTF file (`read_mesh`)
};

/// A line of text that stands on the ground and reaches to the wall (`text_areas`), in units of the
/// surface.
struct TextSpec {
  std::string text;
  std::string font;                ///< name of a TrueType or OpenType file; empty: `usual_font`
  double height{30.0};             ///< of its capitals
  double depth{15.0};              ///< from the wall to its front
  std::optional<double> bridge{};  ///< width of bridges to parts in holes; none: `usual_bridge`
};

/// The shapes of a drawing, upright as its front (`drawing_areas`), in units of the surface.
struct OutlineSpec {
  std::string file;                ///< name of an SVG or DXF file
  std::optional<double> height{};  ///< of the whole; none: as it is drawn, in mm
  double depth{15.0};              ///< from the wall to its front
  std::optional<double> bridge{};  ///< width of bridges to parts in holes; none: `usual_bridge`
};

/// The width of a bridge (`with_bridges`) of letters or a drawing as high as this.
[[nodiscard]] inline double usual_bridge(double height) { return height / 15.0; }

using SurfaceSpec = std::variant<RevolutionSpec, ProfileSpec, ImplicitSpec, GridSpec, MeshSpec,
                                 LoftSpec, TextSpec, OutlineSpec>;

/// Contents of the files that a surface names, by the name as the spec writes it. Who has the files
/// reads them: the command line beside the spec, the daemon among what was uploaded.
using SurfaceAssets = std::map<std::string, std::string>;

/// The file that a surface needs, or empty.
[[nodiscard]] inline std::string asset_of(const SurfaceSpec& surface) {
  if (const auto* grid = std::get_if<GridSpec>(&surface)) return grid->file;
  if (const auto* mesh = std::get_if<MeshSpec>(&surface)) return mesh->file;
  if (const auto* outline = std::get_if<OutlineSpec>(&surface)) return outline->file;
  if (const auto* text = std::get_if<TextSpec>(&surface)) return text->font;
  return {};
}

/// The field of a surface that names its file.
[[nodiscard]] inline const char* asset_field(const SurfaceSpec& surface) {
  return std::holds_alternative<TextSpec>(surface) ? "font" : "file";
}

/// Whether it is a 3D model from a file, which programs can compare a card with.
[[nodiscard]] inline bool is_model(const std::optional<SurfaceSpec>& surface) {
  return surface &&
         (std::holds_alternative<GridSpec>(*surface) || std::holds_alternative<MeshSpec>(*surface));
}

/// What it is if it consists of triangles: "mesh", "grid", "text" or "drawing", which begin and end
/// somewhere along the spine; nullptr for formulas and curves.
[[nodiscard]] inline const char* solid_word(const SurfaceSpec& surface) {
  if (std::holds_alternative<GridSpec>(surface)) return "grid";
  if (std::holds_alternative<MeshSpec>(surface)) return "mesh";
  if (std::holds_alternative<TextSpec>(surface)) return "text";
  if (std::holds_alternative<OutlineSpec>(surface)) return "drawing";
  return nullptr;
}

[[nodiscard]] inline const char* solid_word(const std::optional<SurfaceSpec>& surface) {
  return surface ? solid_word(*surface) : nullptr;
}

[[nodiscard]] inline std::string asset_of(const std::optional<SurfaceSpec>& surface) {
  return surface ? asset_of(*surface) : std::string();
}

/// How the surface stands in the corner of wall and ground (z = 0), y along the spine: a point q of
/// it is at `R_s (R_z R_y R_x (scale_mm q) + translate_mm)`, R the turns about the axes and R_s one
/// about the spine, by which a book turns what each of its cards shows. The wall rises from the
/// spine at `design_angle_deg` to the ground; at 90 it is x = 0.
struct TargetPlacement {
  double scale_mm{1.0};  ///< one unit of the surface
  std::array<double, 3> rotate_deg{};
  std::array<double, 3> translate_mm{};
  double design_angle_deg{90.0};  ///< opening angle at which the structure shows the target
  double about_spine_deg{0.0};    ///< from the wall toward the ground, as a turn about y
};
inline constexpr double kLeastDesignAngle = 30.0, kMostDesignAngle = 150.0;

/// What becomes of parts that no falling curve can follow.
enum class FitMode {
  Exact,   ///< they are an error
  Nearest  ///< the nearest falling curve is taken, with its error in the report
};

/// How much of a target a slice (or a whole design) follows.
struct SliceFit {
  double outline_mm{};      ///< length of the section's boundary in the corner
  double unreachable_mm{};  ///< of it, what no falling curve follows: hidden or moved by the fit
  double visible_mm{};      ///< of it, what is seen from outside the corner
  double rms_mm{};          ///< distance of the seen part from the curve that was taken
  double max_mm{};
};

/// The unreachable part of the boundary, 0 to 1.
[[nodiscard]] inline double unreachable_share(const SliceFit& fit) {
  return fit.outline_mm > 0.0 ? fit.unreachable_mm / fit.outline_mm : 0.0;
}

/// Sums slices: lengths are added, rms is weighted by the seen length.
void accumulate(SliceFit& total, const SliceFit& slice);

}  // namespace popcut

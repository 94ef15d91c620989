// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/design/outline/bridges.hpp"
#include "core/design/outline/drawing_outline.hpp"
#include "core/design/outline/extrusion.hpp"
#include "core/design/outline/text_outline.hpp"
#include "core/design/target/mesh_slicer.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/model/height_grid.hpp"
#include "core/model/model.hpp"

namespace popcut {
namespace {

/// An error about a field of the surface.
tl::unexpected<Error> at(const std::string& field, Error error) {
  return tl::unexpected(within("/surface/" + field, std::move(error)));
}

/// The file that the surface names; of a text that names none the usual font.
Result<std::string_view> bytes_of(const SurfaceSpec& spec, const SurfaceAssets& assets) {
  const std::string file = asset_of(spec);
  if (file.empty() && std::holds_alternative<TextSpec>(spec)) return usual_font();
  const auto found = assets.find(file);
  if (found == assets.end())
    return fail(ErrorKind::Malformed, fmt::format("/surface/{}", asset_field(spec)),
                fmt::format("\"{}\" is not at hand; give the file along with the spec", file));
  return std::string_view(found->second);
}

/// Shapes as a solid, those that stand free in a hole joined to what is around them.
///
/// @param bridge  none: as wide as is usual for this height
Result<TriangleMesh> upright(Result<std::vector<Area>> areas, double depth,
                             std::optional<double> bridge, double height, const std::string& field,
                             std::vector<std::string>* notes) {
  if (!areas) {
    Error error = areas.error();
    if (error.place == "font" || error.place == "text") {
      error.place.insert(0, "/surface/");
      return tl::unexpected(std::move(error));
    }
    return at(field, std::move(error));
  }
  const double width = bridge.value_or(usual_bridge(height));
  const auto joined = with_bridges(std::move(*areas), width);
  if (!joined) return at(field, joined.error());
  if (notes != nullptr && joined->islands > 0)
    notes->push_back(fmt::format(
        "{} free in a hole: two bridges of {:.3g} (units of the surface) hold {}; \"bridge\" of "
        "/surface sets their width, and 0 leaves them out",
        joined->islands == 1 ? "a part stands" : fmt::format("{} parts stand", joined->islands),
        width, joined->islands == 1 ? "it" : "each"));
  return TriangleMesh{extruded(joined->areas, depth)};
}

/// How high shapes are.
double height_of(const Result<std::vector<Area>>& areas) {
  Eigen::AlignedBox2d box;
  if (areas)
    for (const Area& area : *areas)
      for (const Vec2& p : area.outline) box.extend(p);
  return box.isEmpty() ? 0.0 : box.sizes().y();
}

/// All triangles but those that lie on wall or ground.
TriangleSoup standing_triangles(const MeshSlicer& slicer) {
  TriangleSoup out;
  const std::vector<float>& corners = slicer.mesh().corners;
  const double touch = 1e-6 * (slicer.high_mm() - slicer.low_mm());
  out.corners.resize(corners.size());
  double* to = out.corners.data();
  for (std::size_t k = 0; k < corners.size(); k += 9) {
    bool on_wall = true, on_ground = true;
    for (std::size_t c = k; c < k + 9; c += 3) {
      on_wall = on_wall && std::abs(static_cast<double>(corners[c])) <= touch;
      on_ground = on_ground && std::abs(static_cast<double>(corners[c + 2])) <= touch;
    }
    if (on_wall || on_ground) continue;
    for (std::size_t c = k; c < k + 9; ++c) *to++ = static_cast<double>(corners[c]);
  }
  out.corners.resize(static_cast<std::size_t>(to - out.corners.data()));
  return out;
}

}  // namespace

Result<TriangleMesh> triangles_of(const SurfaceSpec& spec, const SurfaceAssets& assets,
                                  std::vector<std::string>* notes) {
  const auto bytes = bytes_of(spec, assets);
  if (!bytes) return tl::unexpected(bytes.error());
  if (const auto* text = std::get_if<TextSpec>(&spec))
    return upright(text_areas(text->text, *bytes, text->height), text->depth, text->bridge,
                   text->height, "text", notes);
  if (const auto* outline = std::get_if<OutlineSpec>(&spec)) {
    auto areas = drawing_areas(std::string(*bytes), outline->height);
    const double height = height_of(areas);
    return upright(std::move(areas), outline->depth, outline->bridge, height, "file", notes);
  }
  const std::string file = asset_of(spec);
  auto mesh = std::holds_alternative<GridSpec>(spec) ? read_height_grid(file, *bytes)
                                                     : read_mesh(file, *bytes, notes);
  if (!mesh) return at("file", mesh.error());
  return mesh;
}

std::vector<Warning> target_warnings(const SurfaceSpec& spec, const SurfaceAssets& assets) {
  std::vector<Warning> warnings;
  const auto* outline = std::get_if<OutlineSpec>(&spec);
  const auto bytes = outline != nullptr ? bytes_of(spec, assets) : Result<std::string_view>("");
  // What cannot be read is an error where the surface is made.
  if (outline != nullptr && bytes)
    static_cast<void>(drawing_areas(std::string(*bytes), outline->height, &warnings));
  return warnings;
}

Result<Surface> surface_of_triangles(TriangleMesh mesh, FitMode fit, const char* what,
                                     bool closed) {
  const auto slicer = std::make_shared<const MeshSlicer>(std::move(mesh));
  const MeshBox& box = slicer->box();
  if (!(box.high[0] > 0.0) || !(box.high[2] > 0.0))
    return fail(
        ErrorKind::Infeasible, "/translate_mm",
        fmt::format(
            "no part of the {} is in the corner x > 0, z > 0: it spans x = {:.4g} to {:.4g}, "
            "z = {:.4g} to {:.4g} mm; move it with translate_mm",
            what, box.low[0], box.high[0], box.low[2], box.high[2]),
        ErrorReason::Misplaced);
  const auto cut = [slicer, fit, what, closed](double s_mm) -> Result<SurfaceSlice> {
    const std::string place = fmt::format("/surface at s = {:.6g} mm", s_mm);
    const double touch = 1e-6 * (slicer->high_mm() - slicer->low_mm());
    if (s_mm < slicer->low_mm() - touch || s_mm > slicer->high_mm() + touch)
      return fail(ErrorKind::Infeasible, place,
                  fmt::format("the {} spans y = {:.6g} to {:.6g} mm only; use fewer or narrower "
                              "slices, a larger scale_mm, or move it along y with translate_mm",
                              what, slicer->low_mm(), slicer->high_mm()),
                  ErrorReason::Misplaced);
    Section section = slicer->cut(s_mm);
    if (!closed) section.open_ends.clear();
    return fit_section(section, fit, place, what);
  };
  return Surface(cut, [slicer](const TargetStretch&) { return standing_triangles(*slicer); });
}

Result<Surface> surface_of_mesh(const SurfaceSpec& spec, const TargetPlacement& placement,
                                FitMode fit, const SurfaceAssets& assets) {
  std::vector<std::string> notes;
  auto mesh = triangles_of(spec, assets, &notes);
  if (!mesh) return tl::unexpected(mesh.error());
  auto standing = placed(std::move(*mesh), placement);
  if (!standing) return tl::unexpected(standing.error());
  const bool closed = !std::holds_alternative<GridSpec>(spec);
  auto surface = surface_of_triangles(std::move(*standing), fit, solid_word(spec), closed);
  if (surface) surface->notes = std::move(notes);
  return surface;
}

}  // namespace popcut

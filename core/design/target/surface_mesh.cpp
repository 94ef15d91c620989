// SPDX-License-Identifier: MIT
#include <memory>

#include <fmt/format.h>

#include "core/design/target/mesh_reader.hpp"
#include "core/design/target/mesh_slicer.hpp"
#include "core/design/target/surface_kinds.hpp"

namespace popcut {
namespace {

Result<std::string_view> bytes_of(const std::string& file, const SurfaceAssets& assets) {
  const auto found = assets.find(file);
  if (found == assets.end())
    return fail(ErrorKind::Malformed, "/surface/file",
                fmt::format("\"{}\" is not at hand; give the file along with the spec", file));
  return std::string_view(found->second);
}

}  // namespace

Result<TriangleMesh> triangles_of(const SurfaceSpec& spec, const SurfaceAssets& assets) {
  const std::string file = asset_of(spec);
  const auto bytes = bytes_of(file, assets);
  if (!bytes) return tl::unexpected(bytes.error());
  auto mesh = std::holds_alternative<GridSpec>(spec) ? read_height_grid(file, *bytes)
                                                     : read_mesh(file, *bytes);
  if (!mesh) return tl::unexpected(within("/surface/file", mesh.error()));
  return mesh;
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
  return Surface([slicer, fit, what, closed](double s_mm) -> Result<SurfaceSlice> {
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
  });
}

Result<Surface> surface_of_file(const SurfaceSpec& spec, const TargetPlacement& placement,
                                FitMode fit, const SurfaceAssets& assets) {
  auto mesh = triangles_of(spec, assets);
  if (!mesh) return tl::unexpected(mesh.error());
  auto standing = placed(std::move(*mesh), placement);
  if (!standing) return tl::unexpected(standing.error());
  const bool closed = std::holds_alternative<MeshSpec>(spec);
  return surface_of_triangles(std::move(*standing), fit, closed ? "mesh" : "grid", closed);
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
// Part of core/verify/target/target.hpp. The design's own parser reads the spec, and the reader of
// models its files; the surfaces that the distances are measured to are made here.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "core/design/spec/spec.hpp"
#include "core/model/height_grid.hpp"
#include "core/model/model.hpp"
#include "core/verify/target/target.hpp"

namespace popcut {
namespace verify {
namespace {

using Surface = std::unique_ptr<TargetSurface>;

TargetPlacement placement_of(const popcut::TargetPlacement& given) {
  return {given.scale_mm, given.rotate_deg, given.translate_mm,
          TargetWall::at_deg(given.design_angle_deg)};
}

/// A formula, or the curve through points.
Result<TargetFormula> formula_of(const FormulaOrPoints& given, const std::string& place,
                                 std::optional<double> length = std::nullopt) {
  if (const auto* points = std::get_if<CurvePoints>(&given)) return formula_through(*points);
  auto formula = read_formula(std::get<std::string>(given), length);
  if (!formula) return fail(ErrorKind::Malformed, place, formula.error().detail);
  return formula;
}

/// The triangles of a file that the spec names.
Result<Surface> surface_of_file(const std::string& name, bool is_grid,
                                const TargetPlacement& placement, const TargetFiles& files) {
  const auto file = files.find(name);
  const std::string bytes = file == files.end() ? std::string() : file->second;
  auto triangles = is_grid ? read_height_grid(name, bytes) : read_mesh(name, bytes);
  if (!triangles) return tl::unexpected(within("/surface/file", triangles.error()));
  return mesh_target(std::move(*triangles), placement);
}

Result<Surface> surface_of(const SurfaceSpec& spec, const TargetPlacement& placement,
                           const TargetFiles& files) {
  if (const auto* grid = std::get_if<GridSpec>(&spec))
    return surface_of_file(grid->file, true, placement, files);
  if (const auto* mesh = std::get_if<MeshSpec>(&spec))
    return surface_of_file(mesh->file, false, placement, files);
  if (const auto* loft = std::get_if<LoftSpec>(&spec)) {
    std::vector<DrawnStation> stations;
    for (const LoftStation& station : loft->stations)
      stations.push_back({station.y, station.curve});
    return loft_target(std::move(stations), placement);
  }
  if (const auto* revolution = std::get_if<RevolutionSpec>(&spec)) {
    auto radius = formula_of(revolution->radius, "/surface/radius");
    if (!radius) return tl::unexpected(radius.error());
    return revolution_target(std::move(*radius), placement);
  }
  if (const auto* profile = std::get_if<ProfileSpec>(&spec)) {
    if (const auto* curve = std::get_if<CurvePoints>(&profile->z))
      return loft_target({{0.0, *curve}}, placement);
    auto z = formula_of(profile->z, "/surface/z");
    if (!z) return tl::unexpected(z.error());
    return profile_target(std::move(*z), placement);
  }
  if (const auto* solid = std::get_if<ImplicitSpec>(&spec)) {
    auto f = formula_of(solid->f, "/surface/f");
    if (!f) return tl::unexpected(f.error());
    return solid_target(std::move(*f), placement);
  }
  return fail(ErrorKind::OutOfRange, "/surface/type",
              "is text or a drawing, from which verify does not measure; use revolution, profile, "
              "implicit, grid, mesh, loft or composite");
}

/// The radius of a stretch of the paper's composite (S2.F): R1 to R2, R2 to R3 and R3 to R2.
TargetFormula composite_radius(const std::array<double, 3>& radii, std::size_t stretch,
                               double length) {
  const double from = radii[stretch], to = radii[stretch == 1 ? 2 : 1];
  return [from, to, length](double, double y, double) {
    return from + (to - from) * (0.5 * (1.0 - std::cos(std::numbers::pi * y / length)));
  };
}

/// A region of the spec: its place along the spine, and how long it is. In mm.
struct RegionPlace {
  double begin_mm{}, first_middle_mm{}, length_mm{};
};

/// Adds the slices of all regions to the target. Where units change, no connector follows.
std::vector<RegionPlace> add_slices(const DesignSpec& spec, Target& target) {
  std::vector<RegionPlace> out;
  double s = 0.0;
  for (const RegionSpec& region : spec.regions) {
    if (!target.slices.empty())
      target.slices.back().cut_after = target.slices.back().units != region.units_per_slice;
    RegionPlace place;
    for (int k = 0; k < region.slices; ++k) {
      const double width = spec.widths_mm[target.slices.size()];
      if (!target.slices.empty()) s += 0.5 * (target.slices.back().width_mm + width);
      if (k == 0) place.begin_mm = s - 0.5 * width, place.first_middle_mm = s;
      place.length_mm += width;
      target.slices.push_back({width, region.units_per_slice, false, 0.0});
    }
    out.push_back(place);
  }
  place_slices(target.slices);
  return out;
}

/// One surface for all regions, or one for each.
Result<Surface> surface_of_regions(const DesignSpec& spec, const std::vector<RegionPlace>& places,
                                   const TargetPlacement& placement, const TargetFiles& files) {
  std::shared_ptr<const TargetSurface> common;
  if (spec.surface) {
    auto made = surface_of(*spec.surface, placement, files);
    if (!made) return tl::unexpected(made.error());
    common = std::move(*made);
  }
  std::vector<TargetStretch> stretches;
  for (std::size_t r = 0; r < places.size(); ++r) {
    if (!spec.regions[r].radius) {
      stretches.push_back({places[r].first_middle_mm, 0.0, common});
      continue;
    }
    const double length = places[r].length_mm / placement.scale_mm;
    auto radius =
        spec.composite_radii
            ? Result<TargetFormula>(composite_radius(*spec.composite_radii, r, length))
            : formula_of(*spec.regions[r].radius, fmt::format("/regions/{}/radius", r), length);
    if (!radius) return tl::unexpected(radius.error());
    stretches.push_back(
        {places[r].begin_mm, places[r].begin_mm, revolution_target(std::move(*radius), placement)});
  }
  return stretched_target(std::move(stretches));
}

/// The target of one design.
Result<Target> target_of(const DesignSpec& spec, const TargetFiles& files) {
  const TargetPlacement placement = placement_of(spec.placement);
  Target target;
  target.patches.push_back({0, spec.card ? spec.card->margin_mm : 0.0});
  target.angle_deg = spec.placement.design_angle_deg;
  target.wall = placement.wall;
  Result<Surface> surface;
  if (spec.adaptive) {
    target.chosen_units = spec.regions.front().units_per_slice;
    surface = surface_of(*spec.surface, placement, files);
  } else {
    const auto places = add_slices(spec, target);
    surface = surface_of_regions(spec, places, placement, files);
  }
  if (!surface) return tl::unexpected(surface.error());
  target.surface = std::move(*surface);
  return target;
}

/// The targets of all patches, one after the other along the spine; a patch begins half a width
/// beyond the middle of the last slice before it.
Result<Target> target_of_patches(const std::vector<DesignSpec>& patches, const TargetFiles& files) {
  Target out;
  std::vector<TargetStretch> stretches;
  double edge_mm = 0.0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const std::string place = fmt::format("/patches/{}", k);
    auto one = target_of(patches[k], files);
    if (!one) {
      Error error = std::move(one.error());
      error.place = place + error.place;
      return tl::unexpected(std::move(error));
    }
    if (one->chosen_units > 0)
      return fail(ErrorKind::OutOfRange, place + "/widths_mm",
                  "verify cannot find chosen widths among patches; give the list of widths that "
                  "report.json shows");
    const double begin_mm = k == 0 ? -0.5 * one->slices.front().width_mm : edge_mm;
    const double origin_mm = begin_mm + 0.5 * one->slices.front().width_mm;
    out.angle_deg = one->angle_deg, out.wall = one->wall;
    if (!out.slices.empty()) out.slices.back().cut_after = true;
    out.patches.push_back({out.slices.size(), one->patches.front().margin_mm});
    for (TargetSlice slice : one->slices) {
      slice.s_mm += origin_mm;
      out.slices.push_back(slice);
    }
    edge_mm = out.slices.back().s_mm + 0.5 * out.slices.back().width_mm;
    stretches.push_back({begin_mm, origin_mm, std::move(one->surface)});
  }
  out.surface = stretched_target(std::move(stretches));
  return out;
}

}  // namespace

Result<Target> read_target(const DesignSpec& spec, const TargetFiles& files) {
  if (is_of_parts(spec))
    return fail(
        ErrorKind::Malformed, "/style",
        "is layers or slices, which have no fold vertices on the shape; leave --target out");
  if (is_of_facets(spec.style))
    return fail(ErrorKind::Malformed, "/style",
                "is facets or a silhouette, which have no fold vertices on the shape; leave "
                "--target out, and see "
                "facets in report.json for the distance");
  return spec.patches.empty() ? target_of(spec, files) : target_of_patches(spec.patches, files);
}

Result<Target> read_target(std::string_view spec_json, const TargetFiles& files) {
  const auto spec = parse_design_spec(spec_json);
  if (!spec) return tl::unexpected(spec.error());
  return read_target(*spec, files);
}

}  // namespace verify

std::vector<std::string> target_files_of(std::string_view spec_json) {
  std::vector<std::string> out;
  const auto spec = parse_design_spec(spec_json);
  if (!spec) return out;
  const auto add = [&](const DesignSpec& design) {
    if (!is_model(design.surface)) return;
    std::string name = asset_of(design.surface);
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  };
  add(*spec);
  for (const DesignSpec& patch : spec->patches) add(patch);
  return out;
}

}  // namespace popcut

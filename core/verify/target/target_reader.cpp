// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"
#include "core/verify/target/target.hpp"

namespace popcut {
namespace verify {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxSpecBytes = 1 << 22;
constexpr int kMaxSpecDepth = 32;
constexpr double kMostSlices = 1e6, kMostUnits = 1e6;
constexpr double kDefaultMargin_mm = 15.0;

tl::unexpected<Error> wrong(std::string place, std::string detail) {
  return fail(ErrorKind::Malformed, std::move(place), std::move(detail));
}

Result<Json> parse_spec(std::string_view text) {
  if (text.size() > kMaxSpecBytes)
    return fail(ErrorKind::OutOfRange, "", "the spec is larger than 4 MiB");
  bool deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    deep = deep || depth > kMaxSpecDepth;
    return !deep;
  };
  Json spec = Json::parse(text, watch, false);
  if (deep || spec.is_discarded()) return wrong("", "the spec is not JSON, or is nested too deep");
  if (!spec.is_object()) return wrong("/", "a design spec must be an object");
  return spec;
}

/// A number from `low` to `high`.
Result<double> number_at(const Json& spec, const std::string& pointer,
                         std::optional<double> otherwise, double low = -1e9, double high = 1e9) {
  const Json::json_pointer at(pointer);
  if (!spec.contains(at)) {
    if (otherwise) return *otherwise;
    return wrong(pointer, "missing; verify needs it to find the slices");
  }
  if (!spec.at(at).is_number()) return wrong(pointer, "must be a number");
  const double value = spec.at(at).get<double>();
  if (!(value >= low && value <= high))
    return fail(
        ErrorKind::OutOfRange, pointer,
        fmt::format("is {}; use a number from {:g} to {:g}", exact_number(value), low, high));
  return value;
}

Result<double> read_angle(const Json& spec) {
  return number_at(spec, "/design_angle_deg", 90.0, 30.0, 150.0);
}

Result<TargetPlacement> read_placement(const Json& spec) {
  TargetPlacement out;
  const auto angle_deg = read_angle(spec);
  if (!angle_deg) return tl::unexpected(angle_deg.error());
  out.wall = TargetWall::at_deg(*angle_deg);
  const auto scale = number_at(spec, "/scale_mm", 1.0, 1e-9);
  if (!scale) return tl::unexpected(scale.error());
  out.scale_mm = *scale;
  for (auto [member, list] :
       {std::pair{"rotate_deg", &out.rotate_deg}, std::pair{"translate_mm", &out.translate_mm}}) {
    if (!spec.contains(member)) continue;
    const std::string place = std::string("/") + member;
    if (!spec[member].is_array() || spec[member].size() != 3)
      return wrong(place, "must be a list of three numbers");
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = number_at(spec, fmt::format("{}/{}", place, k), std::nullopt);
      if (!value) return tl::unexpected(value.error());
      (*list)[k] = *value;
    }
  }
  return out;
}

using Surface = std::unique_ptr<TargetSurface>;

Result<TargetFormula> formula_at(const Json& object, const char* member, const std::string& place,
                                 std::optional<double> length = std::nullopt) {
  const std::string at = fmt::format("{}/{}", place, member);
  if (!object.contains(member) || !object[member].is_string())
    return wrong(at, "must be an expression");
  auto formula = read_formula(object[member].get<std::string>(), length);
  if (!formula) return wrong(at, formula.error().detail);
  return formula;
}

/// Points of a drawn curve.
Result<TargetPoints> points_at(const Json& object, const char* member, const std::string& place) {
  const std::string at = fmt::format("{}/{}", place, member);
  constexpr std::size_t kMostPoints = 100'000;
  if (!object.contains(member) || !object[member].is_array() || object[member].size() < 2 ||
      object[member].size() > kMostPoints)
    return wrong(at, "must be a list of two points or more");
  TargetPoints out;
  for (const Json& point : object[member]) {
    if (!point.is_array() || point.size() != 2 || !point[0].is_number() || !point[1].is_number())
      return wrong(fmt::format("{}/{}", at, out.size()), "must be two numbers");
    out.push_back({point[0].get<double>(), point[1].get<double>()});
    if (!(std::abs(out.back()[0]) <= 1e9 && std::abs(out.back()[1]) <= 1e9))
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}", at, out.size() - 1),
                  "is not a number up to 1e9");
  }
  return out;
}

Result<void> check_growing(const TargetPoints& points, const std::string& place) {
  for (std::size_t k = 1; k < points.size(); ++k)
    if (!(points[k][0] > points[k - 1][0]))
      return fail(ErrorKind::OutOfRange, fmt::format("{}/{}/0", place, k),
                  "must be above that of the point before it");
  return {};
}

/// From (0, h) to (d, 0), never back.
Result<void> check_falling(const TargetPoints& points, const std::string& place) {
  bool falls = points.front()[0] == 0.0 && points.front()[1] > 0.0 && points.back()[0] > 0.0 &&
               points.back()[1] == 0.0;
  for (std::size_t k = 1; k < points.size(); ++k)
    falls = falls && points[k][0] >= points[k - 1][0] && points[k][1] <= points[k - 1][1] &&
            points[k] != points[k - 1];
  if (falls) return {};
  return fail(ErrorKind::OutOfRange, place,
              "must fall from the wall, x = 0, to the ground, z = 0, with no point twice");
}

/// A radius by y: an expression, or points that a curve goes through.
Result<TargetFormula> radius_at(const Json& object, const std::string& place,
                                std::optional<double> length = std::nullopt) {
  if (!object.contains("radius") || !object["radius"].is_object())
    return formula_at(object, "radius", place, length);
  const auto points = points_at(object["radius"], "points", place + "/radius");
  if (!points) return tl::unexpected(points.error());
  if (auto grows = check_growing(*points, place + "/radius/points"); !grows)
    return tl::unexpected(grows.error());
  return formula_through(*points);
}

Result<Surface> drawn_profile(const Json& surface, const TargetPlacement& placement) {
  const auto points = points_at(surface["z"], "points", "/surface/z");
  if (!points) return tl::unexpected(points.error());
  if (auto falls = check_falling(*points, "/surface/z/points"); !falls)
    return tl::unexpected(falls.error());
  return loft_target({{0.0, *points}}, placement);
}

Result<Surface> drawn_loft(const Json& surface, const TargetPlacement& placement) {
  const Json& list = surface.contains("stations") ? surface["stations"] : Json();
  constexpr std::size_t kMostStations = 10'000;
  if (!list.is_array() || list.size() < 2 || list.size() > kMostStations)
    return wrong("/surface/stations", "must be a list of two stations or more");
  std::vector<DrawnStation> stations;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::string place = fmt::format("/surface/stations/{}", k);
    if (!list[k].is_object()) return wrong(place, "must be an object with y and curve");
    const auto y = number_at(list[k], "/y", std::nullopt);
    if (!y) return tl::unexpected(within(place, y.error()));
    const auto curve = points_at(list[k], "curve", place);
    if (!curve) return tl::unexpected(curve.error());
    if (auto falls = check_falling(*curve, place + "/curve"); !falls)
      return tl::unexpected(falls.error());
    if (!stations.empty() && curve->size() != stations[0].curve.size())
      return fail(ErrorKind::OutOfRange, place + "/curve", "must have as many points as the first");
    if (!stations.empty() && !(*y > stations.back().y))
      return fail(ErrorKind::OutOfRange, place + "/y",
                  "must be above that of the station before it");
    stations.push_back({*y, *curve});
  }
  return loft_target(std::move(stations), placement);
}

Result<Surface> read_surface(const Json& surface, const TargetPlacement& placement,
                             const TargetFiles& files) {
  if (!surface.is_object() || !surface.contains("type") || !surface["type"].is_string())
    return wrong("/surface", "must be an object with a type");
  const std::string type = surface["type"].get<std::string>();
  if (type == "grid" || type == "mesh") {
    if (!surface.contains("file") || !surface["file"].is_string())
      return wrong("/surface/file", "must be the name of a file");
    const std::string name = surface["file"].get<std::string>();
    const auto file = files.find(name);
    const std::string bytes = file == files.end() ? std::string() : file->second;
    auto triangles = type == "grid" ? read_target_grid(name, bytes) : read_target_mesh(name, bytes);
    if (!triangles) return tl::unexpected(within("/surface/file", triangles.error()));
    return mesh_target(std::move(*triangles), placement);
  }
  if (type == "loft") return drawn_loft(surface, placement);
  const bool revolution = type == "revolution", profile = type == "profile";
  if (profile && surface.contains("z") && surface["z"].is_object())
    return drawn_profile(surface, placement);
  if (!revolution && !profile && type != "implicit")
    return fail(
        ErrorKind::OutOfRange, "/surface/type",
        fmt::format("\"{}\" is unknown; use revolution, profile, implicit, grid, mesh, loft "
                    "or composite",
                    type.substr(0, 40)));
  auto formula = revolution ? radius_at(surface, "/surface")
                            : formula_at(surface, profile ? "z" : "f", "/surface");
  if (!formula) return tl::unexpected(formula.error());
  if (revolution) return revolution_target(std::move(*formula), placement);
  if (profile) return profile_target(std::move(*formula), placement);
  return solid_target(std::move(*formula), placement);
}

/// The three stretches of the paper's composite (S2.F).
Result<std::array<TargetFormula, 3>> composite_radii(const Json& surface,
                                                     const std::vector<double>& lengths) {
  const Json& radii = surface.contains("radii") ? surface["radii"] : Json();
  if (!radii.is_array() || radii.size() != 3 || !radii[0].is_number() || !radii[1].is_number() ||
      !radii[2].is_number())
    return wrong("/surface/radii", "must be three numbers");
  if (lengths.size() != 3) return wrong("/regions", "a composite surface needs three");
  std::array<TargetFormula, 3> out;
  for (const auto& [k, to] : {std::pair{0U, 1U}, std::pair{1U, 2U}, std::pair{2U, 1U}})
    out[k] = [r0 = radii[k].get<double>(), r1 = radii[to].get<double>(), L = lengths[k]](
                 double, double y, double) {
      return r0 + (r1 - r0) * (0.5 * (1.0 - std::cos(std::numbers::pi * y / L)));
    };
  return out;
}

Result<void> read_widths(const Json& spec, Target& target) {
  const auto units = number_at(spec, "/units_per_slice", 2.0, 1.0, kMostUnits);
  if (!units) return tl::unexpected(units.error());
  const auto slices = number_at(spec, "/slices", std::nullopt, 1.0, kMostSlices);
  if (!slices) return tl::unexpected(slices.error());
  if (spec.contains("widths_mm") && spec["widths_mm"].is_object()) {
    target.chosen_units = static_cast<int>(*units);
    return {};
  }
  const auto count = static_cast<std::size_t>(*slices);
  const bool list = spec.contains("widths_mm") && spec["widths_mm"].is_array();
  if (list && spec["widths_mm"].size() != count)
    return wrong("/widths_mm",
                 fmt::format("{} widths for {} slices", spec["widths_mm"].size(), count));
  for (std::size_t j = 0; j < count; ++j) {
    const auto width =
        number_at(spec, list ? fmt::format("/widths_mm/{}", j) : "/widths_mm", std::nullopt, 1e-9);
    if (!width) return tl::unexpected(width.error());
    target.slices.push_back({*width, static_cast<int>(*units), false, 0.0});
  }
  return {};
}

/// The slices of the regions: where each begins and how long it is.
struct RegionPlaces {
  std::vector<double> origin_mm, middle_mm, length_mm;
};

Result<RegionPlaces> read_regions(const Json& regions, Target& target) {
  RegionPlaces out;
  if (!regions.is_array() || regions.empty() || regions.size() > 1000)
    return wrong("/regions", "must be a list of 1 to 1000 regions");
  double s = 0.0;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const Json& region = regions[r];
    const auto units = number_at(region, "/units_per_slice", std::nullopt, 1.0, kMostUnits);
    const auto slices = number_at(region, "/slices", std::nullopt, 1.0, kMostSlices);
    const bool list =
        region.is_object() && region.contains("widths_mm") && region["widths_mm"].is_array();
    const bool other = region.is_object() && region.contains("widths_mm");
    const std::string place = fmt::format("/regions/{}", r);
    for (const auto* read : {&units, &slices})
      if (!*read) return tl::unexpected(within(place, read->error()));
    const auto count = static_cast<std::size_t>(*slices);
    if (list && region["widths_mm"].size() != count)
      return wrong(place + "/widths_mm",
                   fmt::format("{} widths for {} slices", region["widths_mm"].size(), count));
    if (target.slices.size() + count > kMostSlices)
      return wrong(place, "the spec has more than a million slices");
    if (!target.slices.empty())
      target.slices.back().cut_after = target.slices.back().units != static_cast<int>(*units);
    double length = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const auto width = number_at(region,
                                   list    ? fmt::format("/widths_mm/{}", k)
                                   : other ? "/widths_mm"
                                           : "/width_mm",
                                   std::nullopt, 1e-9);
      if (!width) return tl::unexpected(within(place, width.error()));
      if (!target.slices.empty()) s += 0.5 * (target.slices.back().width_mm + *width);
      if (k == 0) {
        out.origin_mm.push_back(s - 0.5 * *width);
        out.middle_mm.push_back(s);
      }
      length += *width;
      target.slices.push_back({*width, static_cast<int>(*units), false, 0.0});
    }
    out.length_mm.push_back(length);
  }
  return out;
}

/// One surface for all regions, or one per region.
Result<Surface> read_stretches(const Json& spec, const RegionPlaces& places,
                               const TargetPlacement& placement, const TargetFiles& files) {
  const Json& regions = spec["regions"];
  const Json& surface = spec.contains("surface") ? spec["surface"] : Json();
  const bool composite =
      surface.is_object() && surface.contains("type") && surface["type"] == "composite";
  std::vector<double> lengths;
  for (const double length : places.length_mm) lengths.push_back(length / placement.scale_mm);
  std::array<TargetFormula, 3> radii;
  std::shared_ptr<const TargetSurface> common;
  if (composite) {
    auto made = composite_radii(surface, lengths);
    if (!made) return tl::unexpected(made.error());
    radii = std::move(*made);
  } else if (!surface.is_null()) {
    auto made = read_surface(surface, placement, files);
    if (!made) return tl::unexpected(made.error());
    common = std::move(*made);
  }
  std::vector<TargetStretch> stretches;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (!composite && !regions[r].contains("radius")) {
      if (!common)
        return wrong(fmt::format("/regions/{}/radius", r),
                     "missing; give a radius here or a /surface");
      stretches.push_back({places.middle_mm[r], 0.0, common});
      continue;
    }
    auto radius = composite ? Result<TargetFormula>(radii[r])
                            : radius_at(regions[r], fmt::format("/regions/{}", r), lengths[r]);
    if (!radius) return tl::unexpected(radius.error());
    stretches.push_back({places.origin_mm[r], places.origin_mm[r],
                         revolution_target(std::move(*radius), placement)});
  }
  return stretched_target(std::move(stretches));
}

/// The margin of the spec's card.
Result<double> read_margin(const Json& spec) {
  const bool plain =
      spec.contains("card") && spec["card"].is_boolean() && !spec["card"].get<bool>();
  return plain ? Result<double>(0.0) : number_at(spec, "/card/margin_mm", kDefaultMargin_mm, 0.0);
}

/// The target of one design.
Result<Target> read_one(const Json& spec, const TargetFiles& files) {
  const auto placement = read_placement(spec);
  if (!placement) return tl::unexpected(placement.error());
  const auto margin = read_margin(spec);
  if (!margin) return tl::unexpected(margin.error());
  Target target;
  target.patches.push_back({0, *margin});
  Result<Surface> surface;
  if (spec.contains("regions")) {
    const auto places = read_regions(spec["regions"], target);
    if (!places) return tl::unexpected(places.error());
    surface = read_stretches(spec, *places, *placement, files);
  } else {
    if (auto read = read_widths(spec, target); !read) return tl::unexpected(read.error());
    surface = read_surface(spec.contains("surface") ? spec["surface"] : Json(), *placement, files);
  }
  if (!surface) return tl::unexpected(surface.error());
  target.surface = std::move(*surface);
  target.angle_deg = *read_angle(spec);
  target.wall = placement->wall;
  place_slices(target.slices);
  return target;
}

/// The targets of all patches, one after the other along the spine; a patch begins half a width
/// beyond the middle of the last slice before it.
Result<Target> read_patches(const Json& spec, const TargetFiles& files) {
  const Json& patches = spec["patches"];
  constexpr std::size_t kMostPatches = 1000;
  if (!patches.is_array() || patches.empty() || patches.size() > kMostPatches)
    return wrong("/patches", "must be a list of 1 to 1000 designs");
  Target out;
  std::vector<TargetStretch> stretches;
  double edge_mm = 0.0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const std::string place = fmt::format("/patches/{}", k);
    if (!patches[k].is_object()) return wrong(place, "must be an object");
    Json patch = patches[k];
    if (!patch.contains("card") && spec.contains("card")) patch["card"] = spec["card"];
    if (spec.contains("design_angle_deg")) patch["design_angle_deg"] = spec["design_angle_deg"];
    auto one = read_one(patch, files);
    if (!one) {
      Error error = std::move(one.error());
      error.place = place + error.place;
      return tl::unexpected(std::move(error));
    }
    if (one->chosen_units > 0)
      return fail(ErrorKind::OutOfRange, place + "/widths_mm",
                  "verify cannot find chosen widths among patches; give the list of widths that "
                  "report.json shows");
    if (out.slices.size() + one->slices.size() > kMostSlices)
      return wrong(place, "the spec has more than a million slices");
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

Result<Target> read_target(std::string_view spec_json, const TargetFiles& files) {
  const auto spec = parse_spec(spec_json);
  if (!spec) return tl::unexpected(spec.error());
  if (spec->contains("style") && (*spec)["style"] == "facets")
    return wrong("/style",
                 "is facets, which have no fold vertices on the shape; leave --target out, and see "
                 "facets in report.json for the distance");
  return spec->contains("patches") ? read_patches(*spec, files) : read_one(*spec, files);
}

}  // namespace verify

std::vector<std::string> target_files_of(std::string_view spec_json) {
  const auto spec = verify::parse_spec(spec_json);
  if (!spec) return {};
  std::vector<std::string> out;
  const auto add = [&](const verify::Json& design) {
    if (!design.is_object() || !design.contains("surface")) return;
    const auto& surface = design["surface"];
    const auto is_text = [&](const char* member) {
      return surface.is_object() && surface.contains(member) && surface[member].is_string();
    };
    if (!is_text("type") || !is_text("file")) return;
    if (surface["type"] != "mesh" && surface["type"] != "grid") return;
    const auto name = surface["file"].get<std::string>();
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  };
  add(*spec);
  if (spec->contains("patches") && (*spec)["patches"].is_array())
    for (const auto& patch : (*spec)["patches"]) add(patch);
  return out;
}

}  // namespace popcut

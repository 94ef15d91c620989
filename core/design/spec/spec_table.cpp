// SPDX-License-Identifier: MIT
#include "core/design/spec/spec_table.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "core/drawing/paper.hpp"

namespace popcut {
namespace {

using namespace rule;
using nlohmann::json;

constexpr double kMostCurvature = 1e6;  ///< of 1/mm and 1/mm^2: a radius of a nanometre
constexpr double kMostForm = 1e10;      ///< of mm and mm^2: the square of the longest sheet
constexpr double kMostWeight = 1e9;
constexpr std::size_t kMostTargets = 2'000'000;
constexpr std::size_t kMostPatches = 100;
constexpr std::size_t kMostRegions = 1000;
constexpr std::size_t kMostPoints = 1000;        ///< of one curve
constexpr std::size_t kMostStations = 200;       ///< of a loft
constexpr std::size_t kMostLoftPoints = 20'000;  ///< of all stations
constexpr double kMostCoordinate = 1e9;          ///< of a point, in units of the surface
constexpr double kMostAlpha = 1000.0;
constexpr double kRightSum = 2.0 * std::numbers::pi;

ValueRule length_mm(Member into) { return number(into, above(0.0, kMaxLength), "mm"); }

/// The part of an object's schema that asks for one of two or more fields.
json one_of(const char* which, const std::vector<std::string>& names) {
  json schema;
  for (const std::string& name : names) schema[which].push_back({{"required", {name}}});
  return schema;
}

// ---- curves through points

ValueRule points(Member into, std::string_view what) {
  const ValueRule coordinate = number({}, from(-kMostCoordinate, kMostCoordinate));
  return list(into, list({}, coordinate, {2, 2, ErrorKind::Malformed}, "two numbers"),
              {2, kMostPoints}, fmt::format("a list of 2 to {} points {}", kMostPoints, what));
}

/// Neighbours that are nearer than this share of the whole are one.
constexpr double kLeastGap = 1e-9;

/// Points by growing place, whose values are not below zero.
void check_graph(FieldReader& fields, const CurvePoints& points) {
  const double least = kLeastGap * (points.back()[0] - points.front()[0]);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [place, value] = points[k];
    if (k > 0 && !(place - points[k - 1][0] > std::max(0.0, least)))
      return fields.refuse(fmt::format("points/{}/0", k), ErrorKind::OutOfRange,
                           fmt::format("is {:g}; must be above {:g}, where the point before it is",
                                       place, points[k - 1][0]));
    if (!(value >= 0.0))
      return fields.refuse(fmt::format("points/{}/1", k), ErrorKind::OutOfRange,
                           fmt::format("is {:g}; must be a radius of 0 or more", value));
  }
}

/// Points (x, z) that fall from the wall to the ground; `below` is the list's own field.
void check_falls(FieldReader& fields, const std::string& below, const CurvePoints& points) {
  const auto refuse = [&](std::size_t k, int coordinate, double is, const std::string& must) {
    fields.refuse(fmt::format("{}/{}/{}", below, k, coordinate), ErrorKind::OutOfRange,
                  fmt::format("is {:g}; must be {}", is, must));
  };
  const std::size_t last = points.size() - 1;
  const double least = kLeastGap * (points[0][1] + points[last][0]);
  if (points[0][0] != 0.0) return refuse(0, 0, points[0][0], "0: the first point is on the wall");
  if (!(points[0][1] > 0.0))
    return refuse(0, 1, points[0][1], "above 0: the curve begins above the ground");
  for (std::size_t k = 1; k <= last; ++k) {
    const auto &a = points[k - 1], &b = points[k];
    if (b[0] < a[0])
      return refuse(k, 0, b[0],
                    fmt::format("at least {:g}, as the point before it: no point may "
                                "be nearer to the wall",
                                a[0]));
    if (b[1] > a[1])
      return refuse(k, 1, b[1],
                    fmt::format("at most {:g}, as the point before it: the curve must "
                                "fall",
                                a[1]));
    if (!(b[0] - a[0] + a[1] - b[1] > least))
      return fields.refuse(fmt::format("{}/{}", below, k), ErrorKind::OutOfRange,
                           "is the point before it; leave one of them out");
  }
  if (points[last][1] != 0.0)
    return refuse(last, 1, points[last][1], "0: the last point is on the ground");
  if (!(points[last][0] > 0.0))
    refuse(last, 0, points[last][0], "above 0: the curve ends before the wall");
}

/// A formula, or an object with points that `check` accepts.
ValueRule formula_or_points(Member into, std::string_view what,
                            void (*check)(FieldReader&, const CurvePoints&)) {
  const auto table = [into, what, check] {
    FieldTable drawn{{{"points", needed(points(into, what)), what}}};
    drawn.complete = [check](FieldReader& fields) {
      CurvePoints read;
      assign(read, *fields.value("points"));
      check(fields, read);
    };
    return drawn;
  };
  return either({text(into), object(table, "an object with points")});
}

/// A formula or points as a member: `To` is `FormulaOrPoints`, or an optional one.
template <typename To>
Member curve(To* to) {
  return {to, [](void* at, const json& value) {
            FormulaOrPoints read;
            if (value.is_string())
              assign(read.emplace<std::string>(), value);
            else
              assign(read.emplace<CurvePoints>(), value);
            *static_cast<To*>(at) = std::move(read);
          }};
}

ValueRule radius(Member into) {
  return formula_or_points(into, "[y, radius], by growing y", check_graph);
}

// ---- the surface

FieldTable profile_table(ProfileSpec& profile) {
  const auto check = [](FieldReader& fields, const CurvePoints& read) {
    check_falls(fields, "points", read);
  };
  return {{
      {"z",
       needed(formula_or_points(curve(&profile.z), "[x, z], from the wall to the ground", check)),
       "expression of x and y, or points of a curve that is the same for each y"},
  }};
}

FieldTable station_table(LoftStation& station) {
  FieldTable table{{
      {"y", needed(number(&station.y, from(-kMostCoordinate, kMostCoordinate))),
       "place along the spine"},
      {"curve", needed(points(&station.curve, "[x, z], from the wall to the ground")),
       "points [x, z] that fall from the wall, x = 0, to the ground, z = 0"},
  }};
  table.complete = [&station](FieldReader& fields) { check_falls(fields, "curve", station.curve); };
  return table;
}

void check_stations(FieldReader& fields, const std::vector<LoftStation>& stations) {
  std::size_t points = 0;
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const LoftStation &first = stations.front(), &here = stations[k];
    points += here.curve.size();
    if (here.curve.size() != first.curve.size())
      return fields.refuse(fmt::format("stations/{}/curve", k), ErrorKind::OutOfRange,
                           fmt::format("has {} points; must have {} as the first station, since "
                                       "each point is joined to its like",
                                       here.curve.size(), first.curve.size()));
    const double whole = stations.back().y - first.y;
    if (k > 0 && !(here.y - stations[k - 1].y > std::max(0.0, kLeastGap * whole)))
      return fields.refuse(fmt::format("stations/{}/y", k), ErrorKind::OutOfRange,
                           fmt::format("is {:g}; must be above {:g}, where the station before it "
                                       "is",
                                       here.y, stations[k - 1].y));
  }
  if (points > kMostLoftPoints)
    fields.refuse(
        "stations", ErrorKind::OutOfRange,
        fmt::format("have {} points in all; must have at most {}", points, kMostLoftPoints));
}

FieldTable loft_table(LoftSpec& loft) {
  const auto station = [&loft] { return station_table(loft.stations.emplace_back()); };
  FieldTable table{{
      {"stations",
       needed(list({}, object(station, "an object with y and curve"), {2, kMostStations},
                   fmt::format("a list of 2 to {} stations", kMostStations))),
       "curves at places along the spine, by growing y, all with the same number of "
       "points"},
  }};
  table.complete = [&loft](FieldReader& fields) { check_stations(fields, loft.stations); };
  return table;
}

constexpr Range kOutlineLength = above(0.0, kMaxLength), kBridgeWidth = from(0.0, kMaxLength);
constexpr std::string_view kBridgeHelp =
    "width of the bridges that hold a part in a hole; 0: none; if left out 1/15 of the height";

FieldTable text_table(TextSpec& letters) {
  return {{
      {"text", needed(text(&letters.text)), "one line of letters"},
      {"font", file_name(&letters.font),
       "name of a TrueType or OpenType file, relative to the spec; if left out DejaVu Sans Bold"},
      {"height", number(&letters.height, kOutlineLength), "height of its capitals"},
      {"depth", number(&letters.depth, kOutlineLength), "from the wall to its front"},
      {"bridge", number(&letters.bridge, kBridgeWidth), kBridgeHelp},
  }};
}

FieldTable outline_table(OutlineSpec& outline) {
  return {{
      {"file", needed(file_name(&outline.file)), "name of the file, relative to the spec"},
      {"height", number(&outline.height, kOutlineLength),
       "height of the whole; if left out as it is drawn, in mm"},
      {"depth", number(&outline.depth, kOutlineLength), "from the wall to its front"},
      {"bridge", number(&outline.bridge, kBridgeWidth), kBridgeHelp},
  }};
}

/// A surface with one field.
FieldTable one_field(std::string_view name, const ValueRule& rule, std::string_view help) {
  return {{{name, needed(rule), help}}};
}

ValueRule surface(SpecFields& spec) {
  const auto revolution = [&spec] {
    auto& read = spec.surface.emplace().emplace<RevolutionSpec>();
    return one_field("radius", radius(curve(&read.radius)),
                     "expression of y, or points that a smooth curve goes through");
  };
  const auto profile = [&spec] {
    return profile_table(spec.surface.emplace().emplace<ProfileSpec>());
  };
  const auto implicit = [&spec] {
    auto& read = spec.surface.emplace().emplace<ImplicitSpec>();
    return one_field("f", text(&read.f), "expression of x, y and z");
  };
  const auto grid = [&spec] {
    auto& read = spec.surface.emplace().emplace<GridSpec>();
    return one_field("file", file_name(&read.file), "name of the CSV file, relative to the spec");
  };
  const auto mesh = [&spec] {
    auto& read = spec.surface.emplace().emplace<MeshSpec>();
    return one_field("file", file_name(&read.file), "name of the file, relative to the spec");
  };
  const auto letters = [&spec] { return text_table(spec.surface.emplace().emplace<TextSpec>()); };
  const auto outline = [&spec] {
    return outline_table(spec.surface.emplace().emplace<OutlineSpec>());
  };
  const auto loft = [&spec] { return loft_table(spec.surface.emplace().emplace<LoftSpec>()); };
  const auto composite = [&spec] {
    return one_field(
        "radii",
        blamed(triple(&spec.composite_radii, above(0.0), "three positive numbers, R1, R2 and R3")),
        "R1, R2 and R3, where R1 > R3 > R2");
  };
  return tagged({
      {"revolution", object(revolution),
       "quarter circles about the spine: x^2 + z^2 = radius(y)^2"},
      {"profile", object(profile), "a profile that falls from the wall to the ground for each y"},
      {"implicit", object(implicit), "a solid: inside where f(x, y, z) < 0"},
      {"grid", object(grid),
       "heights over a grid: a CSV file. Its first row holds the x values and its first column the "
       "y values; the cell where they meet is empty"},
      {"mesh", object(mesh), "triangles: an STL or OBJ file"},
      {"text", object(letters), "letters that stand on the ground"},
      {"outline", object(outline),
       "the closed lines and filled shapes of a drawing, upright: an SVG or DXF file"},
      {"loft", object(loft), "a surface through falling curves at places along the spine"},
      {"composite", object(composite), "three regions whose radius runs R1, R2, R3"},
  });
}

// ---- widths and regions

ValueRule fixed_widths(WidthFields& widths) {
  return either({length_mm(&widths.all_mm), list(&widths.each_mm, length_mm({}), {0, kMaxSlices},
                                                 "a list with the width of each slice")});
}

FieldTable adaptive_table(AdaptiveWidths& widths) {
  return {{
      {"max_error_mm", needed(length_mm(&widths.max_error_mm)),
       "largest distance between the target and its slices: how far the target bulges between "
       "neighbouring ones"},
      {"length_mm", length_mm(&widths.length_mm), "length of the whole along the spine"},
  }};
}

ValueRule any_widths(WidthFields& widths) {
  const auto adaptive = [&widths] { return adaptive_table(widths.adaptive.emplace()); };
  std::vector<ValueRule> forms = fixed_widths(widths).parts;
  forms.push_back(object(adaptive, "an object with max_error_mm"));
  return either(std::move(forms));
}

ValueRule units(Member into) { return whole(into, 1, kMaxUnitsPerSlice); }
ValueRule slice_count(Member into) { return whole(into, 1, kMaxSlices); }

FieldTable region_table(RegionFields& region) {
  FieldTable table{{
      {"units_per_slice", needed(units(&region.units_per_slice)), "pop-up units of each slice"},
      {"slices", needed(slice_count(&region.slices)), "number of slices"},
      {"radius", radius(curve(&region.radius)),
       "radius of a surface of revolution: expression of y, from 0 to L in the region, or "
       "points that a smooth curve goes through"},
      {"width_mm", length_mm(&region.widths.all_mm), "width of all its slices"},
      {"widths_mm", fixed_widths(region.widths),
       "one width for all its slices, or a list with one for each slice"},
  }};
  table.exactly_one = {"width_mm", "widths_mm"};
  return table;
}

ValueRule regions(SpecFields& spec) {
  const auto region = [&spec] { return region_table(spec.region_fields.emplace_back()); };
  return list({}, object(region), {1, kMostRegions, ErrorKind::Malformed},
              fmt::format("a list of 1 to {} regions, such as [{{\"units_per_slice\": 3, "
                          "\"slices\": 5, \"width_mm\": 10}}]",
                          kMostRegions));
}

// ---- splay

ValueRule alpha(SplaySpec& splay) {
  const Range tangent = from(0.0, kMostAlpha);
  const ValueRule level =
      list({}, number({}, tangent), {0, kMaxSlices, ErrorKind::Malformed},
           fmt::format("a list of numbers from 0 to {:g}, one for each connector", kMostAlpha));
  return either({blamed(number(&splay.uniform, tangent)),
                 list(&splay.alpha, blamed(level), {1, kMaxUnitsPerSlice, ErrorKind::Malformed},
                      "a list of them for each inner level")});
}

/// "+" or "-" as +1 or -1; anything else is 0.
Member sign(int* to) {
  return {to, [](void* at, const json& value) {
            const std::string sign = value.is_string() ? value.get<std::string>() : "";
            *static_cast<int*>(at) = sign == "+" ? 1 : sign == "-" ? -1 : 0;
          }};
}

FieldTable target_table(CurvatureTarget& target) {
  FieldTable table{{
      {"psi_rad", needed(number(&target.psi_rad, above(0.0, std::numbers::pi))),
       "opening angle, from 0 (shut) to pi (flat)"},
      {"K", number(&target.K_rad, from(-20.0, kRightSum)),
       "angle defect at the middle fold vertex, rad"},
      {"sign", any(sign(&target.sign), {{"enum", {"+", "-"}}}, "\"+\" or \"-\""),
       "sign of the angle defect, in place of K"},
      {"margin_rad", number(&target.margin_rad, from(0.0, kRightSum)),
       "how far from 0 a defect with a sign is at least"},
  }};
  table.complete = [&target](FieldReader& fields) {
    const bool has_sign = target.sign != 0;
    if (target.K_rad.has_value() == has_sign || fields.has("sign") != has_sign)
      fields.refuse(ErrorKind::Malformed, "needs either \"K\" (rad) or \"sign\": \"+\" or \"-\"");
  };
  table.more = one_of("oneOf", {"K", "sign"});
  return table;
}

FieldTable splay_table(SplaySpec& splay, std::optional<double>& given_ligament_mm) {
  const auto target = [&splay] { return target_table(splay.targets.emplace_back()); };
  FieldTable table{{
      {"alpha", alpha(splay),
       "tangent of the splay angle: one number, or a list for each inner level with a "
       "number for each connector (0: no V-fold)"},
      {"targets",
       list({}, object(target), {1, 3, ErrorKind::Malformed},
            "a list of one to three targets, since three splays are solved for"),
       "in place of alpha: what the middle fold vertex does at one to three opening "
       "angles"},
      {"length_mm", length_mm(&splay.length_mm),
       "length of a V-fold along its crease; as long as the connector allows if left out"},
      {"ligament_mm", number(&given_ligament_mm, from(0.0, kMaxLength), "mm"),
       "paper left beside V-folds; if left out 1, min_panel_mm, or the shortest fold that "
       "the material dashes well, whichever is most"},
  }};
  table.exactly_one = {"alpha", "targets"};
  return table;
}

// ---- curvature

ValueRule curvatures(std::vector<double>& read) {
  const Range range = from(-kMostCurvature, kMostCurvature);
  return either({number(appended(&read), range), list(&read, number({}, range), {1, kMostTargets},
                                                      "a list with a number for each inner "
                                                      "vertex")});
}

ValueRule forms(std::vector<std::array<double, 3>>& read) {
  const auto form = [](Member into) {
    return triple(into, from(-kMostForm, kMostForm), "[ss, st, tt], a list of three numbers");
  };
  return either({form(appended(&read)), list(&read, form({}), {1, kMostTargets},
                                             "a list with one for each inner vertex")});
}

/// What the values of a curvature contradict: a form that measures no area.
void check_forms(FieldReader& fields, const AugmentedSpec& spec) {
  for (std::size_t k = 0; k < spec.first.size(); ++k) {
    const auto& [ss, st, tt] = spec.first[k];
    if (ss > 0.0 && tt > 0.0 && ss * tt > st * st) continue;
    return fields.refuse(spec.first.size() == 1 ? "first" : fmt::format("first/{}", k),
                         ErrorKind::OutOfRange,
                         fmt::format("is [{:g}, {:g}, {:g}], which measures no area; ss > 0, "
                                     "tt > 0 and ss tt > st^2 are needed",
                                     ss, st, tt));
  }
}

/// A weight is 1 for what is asked for, and there is none for anything else.
void set_weights(FieldReader& fields, AugmentedSpec& read, const WeightFields& given) {
  const auto set = [&](const char* name, const char* of, bool asked,
                       const std::optional<double>& weight, double& to) {
    if (!asked && weight)
      fields.refuse(fmt::format("weights/{}", name), ErrorKind::Malformed,
                    fmt::format("weighs what is not asked for; give {} too", fields.pointer(of)));
    to = weight.value_or(asked ? 1.0 : 0.0);
  };
  set("K", "K_area", !read.K_area.empty(), given.K, read.weight_K);
  set("H", "H", !read.H.empty(), given.H, read.weight_H);
  set("first", "first", !read.first.empty(), given.first, read.weight_first);
  set("second", "second", !read.second.empty(), given.second, read.weight_second);
  if (!(read.weight_K + read.weight_H + read.weight_first + read.weight_second > 0.0))
    fields.refuse("weights", ErrorKind::OutOfRange,
                  "are all 0; one must be above 0, or leave curvature out");
}

FieldTable weight_table(WeightFields& weights) {
  const auto weight = [](Member into) {
    ValueRule rule = number(into, from(0.0, kMostWeight));
    rule.usual = 1;  // where its curvature is given
    return rule;
  };
  return {{
      {"K", weight(&weights.K), "weight of K_area"},
      {"H", weight(&weights.H), "weight of H"},
      {"first", weight(&weights.first), "weight of first"},
      {"second", weight(&weights.second), "weight of second"},
  }};
}

FieldTable curvature_table(AugmentedSpec& read, WeightFields& weights) {
  FieldTable table{{
      {"K_area", curvatures(read.K_area), "Gaussian curvature, 1/mm^2"},
      {"H", curvatures(read.H), "mean curvature, 1/mm, above 0 where convex"},
      {"first", forms(read.first),
       "first fundamental form [a_ss, a_st, a_tt], mm^2: s along a slice, t across slices"},
      {"second", forms(read.second), "second fundamental form [b_ss, b_st, b_tt], mm"},
      {"weights", object([&weights] { return weight_table(weights); }),
       "how much each of them counts"},
  }};
  table.complete = [&read, &weights](FieldReader& fields) {
    if (read.K_area.empty() && read.H.empty() && read.first.empty() && read.second.empty())
      return fields.refuse(ErrorKind::Malformed,
                           "asks for nothing; give K_area, H, first or second");
    const std::size_t before = fields.faults().size();
    check_forms(fields, read);
    if (fields.faults().size() == before) set_weights(fields, read, weights);
  };
  table.more = one_of("anyOf", {"K_area", "H", "first", "second"});
  return table;
}

// ---- facets

FieldTable facet_table(FacetSpec& facets, std::optional<double>& given_from_mm) {
  constexpr double kMostHingeCost = 1e6;
  constexpr int kMostFolds = 100'000;
  const auto cost = [](Member into) { return number(into, from(0.0, kMostWeight), "mm^2"); };
  return {{
      {"pitch_mm", number(&facets.pitch_mm, from(0.1, kMaxLength), "mm"),
       "distance between the planes that are tried; planes in which much of the target lies are "
       "tried too"},
      {"strip_mm", number(&facets.strip_mm, from(0.1, kMaxLength), "mm"),
       "width of a strip: contours are that fine along the spine"},
      {"from_mm", number(&given_from_mm, from(-kMaxLength, kMaxLength), "mm"),
       "where it begins along the spine; if left out where a mesh, grid, text or drawing does, "
       "else at 0"},
      {"length_mm", length_mm(&facets.length_mm),
       "length along the spine; if left out all of a mesh, grid, text or drawing"},
      {"fold_cost_mm2", cost(&facets.fold_cost_mm2),
       "what a fold costs for each mm of its length: as much as this area 1 mm off the target. "
       "More makes fewer folds"},
      {"hinge_cost_mm3", number(&facets.hinge_cost_mm3, from(0.0, kMostHingeCost), "mm^3"),
       "what a fold costs however long it is: as much as this volume between card and target. More "
       "makes fewer, longer folds"},
      {"jump_cost_mm2", cost(&facets.jump_cost_mm2), "the same of a cut along the spine"},
      {"cut_cost_mm2", cost(&facets.cut_cost_mm2),
       "the same of a cut across the spine. More makes larger patches"},
      {"most_folds", whole(&facets.most_folds, 0, kMostFolds),
       "a card of no more folds, the best that is found; 0: as many as come"},
      {"min_fold_mm", number(&facets.widen_to_mm, from(0.0, 100.0), "mm"),
       "shorter folds are made longer, or their panels left out, where the card still holds then"},
      {"curved", word(&facets.curved, {"lattice", "facets"}),
       "how curved parts hold. lattice: by panels in planes of their own from strip to strip, "
       "which are moved to where the target is; facets: by struts, as planar parts do"},
      {"hold", word(&facets.hold, {"exact", "paper"}),
       "paper: panels hold at folds that lie far enough apart, so that a fold 0.1 mm off its line "
       "moves none much; exact: any two different places hold, as in exact geometry"},
      {"sloped", word(&facets.sloped, {"none", "kites", "tents"}),
       "what planes that slope away from the wall become, such as roofs with their ridge along the "
       "spine. kites: sloped panels of the same sheet; tents: panels of their own paper, glued on "
       "the sheet; none: stairs"},
      {"inward", flag(&facets.inward),
       "true: parts of the target behind wall and ground are made too, where nothing is in front "
       "of them"},
  }};
}

FieldTable silhouette_table(FacetSpec& facets, std::optional<double>& given_from_mm) {
  return {{
      {"layers", whole(&facets.layers, 1, kMostLayers),
       "upright planes: 1 is a cut-out, more follow the shape in depth and have more folds"},
      {"min_fold_mm", number(&facets.min_fold_mm, from(2.0, 100.0), "mm"),
       "no strut is narrower, and no layer stands on less"},
      {"from_mm", number(&given_from_mm, from(-kMaxLength, kMaxLength), "mm"),
       "where it begins along the spine; if left out where a mesh, grid, text or drawing does, "
       "else at 0"},
      {"length_mm", length_mm(&facets.length_mm),
       "length along the spine; if left out all of a mesh, grid, text or drawing"},
  }};
}

FieldTable layers_table(LayersSpec& layers, FacetSpec& facets,
                        std::optional<double>& given_from_mm) {
  return {{
      {"layers", whole(&layers.layers, kLeastCardLayers, kMostLayers),
       "how many at most; a shape that is not deep enough has fewer"},
      {"opens_deg", number(&layers.opens_deg, from(90.0, 180.0)),
       "angle between the pages when the card is open: 180, or 90 with layers on one page"},
      {"page_mm", length_mm(&layers.page_mm),
       "width of each page, from the spine; if left out as the layers need"},
      {"spine_mm", length_mm(&layers.spine_mm),
       "length of the spine; if left out as the layers need"},
      {"from_mm", number(&given_from_mm, from(-kMaxLength, kMaxLength), "mm"),
       "where a shape given by a formula begins along y; if left out at 0"},
      {"length_mm", length_mm(&facets.length_mm), "its length along y"},
  }};
}

FieldTable slices_table(SlicesSpec& sliced) {
  return {{
      {"x_slices", whole(&sliced.x_slices, kLeastSlices, kMostCrossedSlices),
       "how many slices across the x axis, beside the one that is glued to a page"},
      {"y_slices", whole(&sliced.y_slices, kLeastSlices, kMostCrossedSlices),
       "how many across the y axis, beside the one that is glued to a page"},
      {"frame_deg", number(&sliced.frame_deg, from(30.0, 60.0)),
       "angle between the spine and all slices, on open pages; at 45 both families are square"},
      {"paper_mm", number(&sliced.paper_mm, from(0.05, 2.0), "mm"),
       "thickness of the paper; slots are as wide as it needs, times looseness"},
      {"looseness", number(&sliced.looseness, from(1.0, 5.0)),
       "width of slots over what the paper needs on open pages"},
      {"base_mm", number(&sliced.base_mm, from(8.0, 60.0), "mm"),
       "height of the strips of paper that the shape stands on"},
      {"page_mm", length_mm(&sliced.page_mm),
       "width of each page, from the spine; if left out as the slices need"},
      {"spine_mm", length_mm(&sliced.spine_mm),
       "length of the spine; if left out as the slices need"},
  }};
}

FieldTable boxes_table(BoxesSpec& boxes) {
  return {{
      {"most", whole(&boxes.most, 1, kMostBoxes),
       "how many boxes and tents at most; a shape that needs more is an error"},
      {"page_mm", length_mm(&boxes.page_mm),
       "width of each page, from the spine; if left out as the boxes need"},
      {"spine_mm", length_mm(&boxes.spine_mm),
       "length of the spine; if left out as the boxes need"},
  }};
}

// ---- what is shared, and the patches

FieldTable card_table(CardSpec& card) {
  return {{
      {"wall_mm", length_mm(&card.wall_mm),
       "height of the wall, H; if left out, 15 above the highest fold, and large enough for shut"},
      {"ground_mm", length_mm(&card.ground_mm),
       "depth of the ground, D; if left out, 15 beyond the farthest fold, and large enough for "
       "shut"},
      {"margin_mm", number(&card.margin_mm, from(0.1, kMaxLength), "mm"),
       "width of the plain strips at both sides, and of the card around the shut structure"},
      {"shut", word(&card.shut, {"inside", "free"}),
       "inside: the shut structure lies inside the card; free: it may stick out"},
  }};
}

/// false for no card, or its measures.
ValueRule card(std::optional<CardSpec>& card) {
  const Member is_there(&card, [](void* at, const json& value) {
    auto& to = *static_cast<std::optional<CardSpec>*>(at);
    to = value.get<bool>() ? std::optional(CardSpec{}) : std::nullopt;
  });
  ValueRule with = flag(is_there);
  with.what = "false";
  return either({with, object([&card] { return card_table(card.emplace()); },
                              "an object with wall_mm, ground_mm, margin_mm, shut")});
}

/// A paper by its name, or [width, height].
ValueRule sheet(std::optional<SheetSpec>& sheet) {
  const Member named(
      &sheet,
      [](void* at, const json& index) {
        const Paper& paper = kPapers.at(index.get<std::size_t>());
        *static_cast<std::optional<SheetSpec>*>(at) = {paper.name, paper.width_mm, paper.height_mm};
      },
      true);
  const Member measured(&sheet, [](void* at, const json& sides) {
    *static_cast<std::optional<SheetSpec>*>(at) = {"", sides[0].get<double>(),
                                                   sides[1].get<double>()};
  });
  std::vector<std::string> names;
  names.reserve(kPapers.size());
  for (const Paper& paper : kPapers) names.emplace_back(paper.name);
  return either({word(named, names), list(measured, length_mm({}), {2, 2, ErrorKind::Malformed},
                                          "[width, height] in mm")});
}

ValueRule joins(SpecFields& spec) {
  const auto join = [](Member into) { return blamed(word(into, {"auto", "sheet", "seam"})); };
  ValueRule rule =
      either({join(&spec.join_of_all), list({}, join(appended(&spec.joins)), {1, kMostPatches - 1},
                                            "a list with a word for each border")});
  rule.usual = "auto";
  return rule;
}

FieldTable book_table(BookSpec& book) {
  return {{
      {"cards", needed(whole(&book.cards, kLeastCards, kMostCards)),
       "how many; each is open to 360 degrees by this number"},
  }};
}

// ---- the whole

FieldTable whole_table(SpecFields& spec) {
  return {{
      {"popcut", needed(whole(&spec.version, 1, 1)), "version of this format"},
      {"material", text(&spec.material), "name of the material"},
      {"pen", text(&spec.pens),
       "settings of the tool in place of the material's, as --pen of popcut plan gives them: "
       "\"cut: force=90; outline: passes=2\""},
      {"sheet", sheet(spec.sheet),
       "what it is cut from, to be warned of a pattern that is larger: a paper by its name, or "
       "[width, height] in mm"},
      {"design_angle_deg",
       number(&spec.placement.design_angle_deg, from(kLeastDesignAngle, kMostDesignAngle)),
       "opening angle of the card, between wall and ground, at which the structure shows the "
       "target"},
      {"book", object([&spec] { return book_table(spec.book.emplace()); }, "an object with cards"),
       "a book of cards around one spine, glued back to back, that shows the target from all "
       "sides. In a book fit is nearest if left out; a mesh without rotate_deg has its z axis "
       "along the spine, one without translate_mm its middle there"},
  }};
}

FieldTable shared_table(SpecFields& spec) {
  return {{
      {"fit", word(&spec.fit, {"exact", "nearest"}),
       "what becomes of parts that no curve falling from wall to ground can follow: an error, or "
       "the nearest curve that falls"},
      {"lattice", word(&spec.lattice, {kLatticeNames.begin(), kLatticeNames.end()}),
       "how the levels of neighbouring slices are paired, auto: the way that comes nearest to the "
       "target; if left out auto, \"slices\" beside curvature, \"conformal\" beside splay"},
      {"solver", word(&spec.solver, {"newton", "slsqp"}),
       "how the pop-up units of a slice are fitted to the target"},
      {"card", card(spec.card),
       "wall, ground and margins around the design; false leaves them out"},
      {"min_panel_mm", length_mm(&spec.given_min_panel_mm),
       "smallest panel, along the strip; if left out 0.5, or 3 times the thickness of the material "
       "if that is more"},
      {"max_step_over_mean", number_or_null(&spec.max_step_over_mean, above(1.0, 1e6)),
       "largest step of a conformal lattice over the mean one; null: no limit"},
  }};
}

FieldTable design_table(SpecFields& spec) {
  TargetPlacement& placement = spec.placement;
  const auto facets = [&spec] { return facet_table(spec.facets, spec.given_from_mm); };
  const auto silhouette = [&spec] { return silhouette_table(spec.facets, spec.given_from_mm); };
  const auto layers = [&spec] {
    return layers_table(spec.layers, spec.facets, spec.given_from_mm);
  };
  const auto sliceform = [&spec] { return slices_table(spec.sliced); };
  const auto boxes = [&spec] { return boxes_table(spec.boxes); };
  const auto splay = [&spec] { return splay_table(spec.splay.emplace(), spec.given_ligament_mm); };
  const auto curvature = [&spec] {
    return curvature_table(spec.curvature.emplace(), spec.weights);
  };
  return {{
      {"style", word(&spec.style, {"lattice", "facets", "silhouette", "layers", "slices", "boxes"}),
       "what it is made of: lattice, slices of falling staircases; facets, origamic architecture: "
       "patches parallel to wall and ground, with cuts along contours; silhouette: a few upright "
       "layers with the outline of the shape, and few folds; layers: upright layers of several "
       "parts on a card that opens flat, to glue; slices: crossing slices of a solid, pushed "
       "together, on a card that opens flat; boxes: walls and roofs of houses, on a card that "
       "opens "
       "flat"},
      {"facets", object(facets),
       "in place of units_per_slice, slices, widths_mm and regions, beside \"style\": \"facets\""},
      {"silhouette", object(silhouette), "the same, beside \"style\": \"silhouette\""},
      {"layers", object(layers), "the same, beside \"style\": \"layers\""},
      {"sliceform", object(sliceform), "the same, beside \"style\": \"slices\""},
      {"boxes", object(boxes), "the same, beside \"style\": \"boxes\""},
      {"surface", surface(spec), "the target"},
      {"scale_mm", length_mm(&placement.scale_mm), "length of one unit of the surface"},
      {"rotate_deg",
       triple(&placement.rotate_deg, from(-3600.0, 3600.0), "a list of three numbers [x, y, z]"),
       "turns of the scaled surface about the x, then the y, then the z axis; x points away from "
       "the wall, y along the spine, z up"},
      {"translate_mm",
       triple(&placement.translate_mm, from(-kMaxLength, kMaxLength),
              "a list of three numbers [x, y, z]"),
       "shift of the scaled and turned surface"},
      {"regions", regions(spec),
       "in place of units_per_slice, slices and widths_mm: stretches along the spine, each with "
       "its own"},
      {"units_per_slice", units(&spec.units_per_slice), "pop-up units of each slice"},
      {"slices", slice_count(&spec.slices),
       "number of slices; the largest number where widths_mm has max_error_mm and length_mm"},
      {"widths_mm", any_widths(spec.widths),
       "one width for all slices, a list with one for each slice, or an object: widths chosen from "
       "the target's curvature"},
      {"splay", object(splay), "V-folds on the valley creases of the connectors"},
      {"curvature", object(curvature),
       "curvature that the surface through the fold vertices must have: one value for all inner "
       "vertices, or a list with one for each. The list holds levels 1 to units - 1 of the second "
       "slice, then of the third, up to the last but one"},
  }};
}

FieldTable patches_table(SpecFields& spec) {
  return {{
      {"patches",
       needed(list(&spec.patch_fields, any({}, json::object(), "a design"),
                   {2, kMostPatches, ErrorKind::Malformed},
                   fmt::format("a list of 2 to {} designs", kMostPatches))),
       "designs that are joined one after another along the spine. Each has the fields of a design "
       "except popcut, material, pen, sheet, design_angle_deg and book. card, fit, lattice, "
       "solver, min_panel_mm and max_step_over_mean beside patches are the defaults of those"},
      {"join", joins(spec),
       "auto: one sheet where walls and grounds agree, else a seam; sheet: one sheet or an error; "
       "seam: separate patterns that are glued. One word for all borders, or a list"},
      {"join_tolerance_mm", number(&spec.join_tolerance_mm, from(0.0, kMaxLength), "mm"),
       "largest distance between the profiles of two edges that are joined"},
  }};
}

}  // namespace

SpecTables spec_tables(SpecFields& spec) {
  return {whole_table(spec),
          {{{"name", text(&spec.name), "name of the design"}}},
          shared_table(spec),
          design_table(spec),
          patches_table(spec)};
}

}  // namespace popcut

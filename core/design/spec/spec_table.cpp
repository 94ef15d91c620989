// SPDX-License-Identifier: MIT
#include "core/design/spec/spec_table.hpp"

#include <algorithm>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "core/drawing/paper.hpp"

namespace popcut {
namespace {

using nlohmann::json;
using shape::above;
using shape::from;

constexpr double kMostCurvature = 1e6;  ///< of 1/mm and 1/mm^2: a radius of a nanometre
constexpr double kMostForm = 1e10;      ///< of mm and mm^2: the square of the longest sheet
constexpr double kMostWeight = 1e9;
constexpr std::size_t kMostTargets = 2'000'000;
constexpr std::size_t kMostPatches = 100;
constexpr std::size_t kMostRegions = 1000;
constexpr std::size_t kMostNameBytes = 1024;
constexpr std::size_t kMostPoints = 1000;        ///< of one curve
constexpr std::size_t kMostStations = 200;       ///< of a loft
constexpr std::size_t kMostLoftPoints = 20'000;  ///< of all stations
constexpr double kMostCoordinate = 1e9;          ///< of a point, in units of the surface
constexpr double kMostAlpha = 1000.0;
constexpr double kRightSum = 2.0 * std::numbers::pi;

Shape<double> length() { return shape::number(above(0.0, kMaxLength), "mm"); }

Shape<std::string> file_name() {
  Shape<std::string> file = shape::text();
  file.schema.update({{"minLength", 1}, {"maxLength", kMostNameBytes}});
  file.read = [read = file.read](FieldReader& fields, const std::string& below, const json& value) {
    auto name = read(fields, below, value);
    if (name &&
        (name->empty() || name->size() > kMostNameBytes || name->find('\0') != std::string::npos)) {
      fields.refuse(below, ErrorKind::OutOfRange,
                    fmt::format("is not a file name; must have 1 to {} characters", kMostNameBytes),
                    "length");
      name.reset();
    }
    return name;
  };
  return file;
}

/// Two fields of which only one may stand.
void check_clash(FieldReader& fields, const char* one, const char* other) {
  if (fields.has(one) && fields.has(other))
    fields.refuse(one, ErrorKind::Malformed,
                  fmt::format("contradicts {}; give one of them", fields.pointer(other)));
}

// ---- the surface

template <typename Spec>
FieldTable<Spec> one_text(const char* name, std::string Spec::*member,
                          const Shape<std::string>& text, const char* help) {
  return {{needed<Spec>(name, member, text, help)}};
}

// ---- curves through points

struct PointFields {
  CurvePoints points;
};

Shape<CurvePoints> points(const std::string& what) {
  const auto number = shape::number(from(-kMostCoordinate, kMostCoordinate));
  const auto pair = shape::as<std::array<double, 2>>(
      shape::list(number, {2, 2, ErrorKind::Malformed}, "two numbers"),
      [](const std::vector<double>& p) {
        return std::array{p[0], p[1]};
      });
  return shape::list(pair, {2, kMostPoints, ErrorKind::OutOfRange},
                     fmt::format("a list of 2 to {} points {}", kMostPoints, what));
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
Shape<FormulaOrPoints> formula_or(
    const std::string& what, const std::function<void(FieldReader&, const CurvePoints&)>& check) {
  FieldTable<PointFields> table{{
      needed<PointFields>("points", &PointFields::points, points(what), what),
  }};
  table.check = [check](FieldReader& fields, PointFields& read) { check(fields, read.points); };
  const auto drawn = shape::as<FormulaOrPoints>(
      shape::object(table, "an object with points"),
      [](PointFields read) { return FormulaOrPoints(std::move(read.points)); });
  return shape::either(
      shape::as<FormulaOrPoints>(shape::text(),
                                 [](std::string text) { return FormulaOrPoints(std::move(text)); }),
      drawn);
}

Shape<FormulaOrPoints> radius() { return formula_or("[y, radius], by growing y", check_graph); }

FieldTable<LoftSpec> loft() {
  FieldTable<LoftStation> station{{
      needed<LoftStation>("y", &LoftStation::y,
                          shape::number(from(-kMostCoordinate, kMostCoordinate)),
                          "place along the spine"),
      needed<LoftStation>("curve", &LoftStation::curve,
                          points("[x, z], from the wall to the ground"),
                          "points [x, z] that fall from the wall, x = 0, to the ground, z = 0"),
  }};
  station.check = [](FieldReader& fields, LoftStation& read) {
    check_falls(fields, "curve", read.curve);
  };
  FieldTable<LoftSpec> table{{
      needed<LoftSpec>(
          "stations", &LoftSpec::stations,
          shape::list(shape::object(station, "an object with y and curve"),
                      {2, kMostStations, ErrorKind::OutOfRange},
                      fmt::format("a list of 2 to {} stations", kMostStations)),
          "curves at places along the spine, by growing y, all with the same number of points"),
  }};
  table.check = [](FieldReader& fields, LoftSpec& read) {
    std::size_t points = 0;
    for (std::size_t k = 0; k < read.stations.size(); ++k) {
      const LoftStation &first = read.stations.front(), &here = read.stations[k];
      points += here.curve.size();
      if (here.curve.size() != first.curve.size())
        return fields.refuse(fmt::format("stations/{}/curve", k), ErrorKind::OutOfRange,
                             fmt::format("has {} points; must have {} as the first station, since "
                                         "each point is joined to its like",
                                         here.curve.size(), first.curve.size()));
      const double whole = read.stations.back().y - first.y;
      if (k > 0 && !(here.y - read.stations[k - 1].y > std::max(0.0, kLeastGap * whole)))
        return fields.refuse(fmt::format("stations/{}/y", k), ErrorKind::OutOfRange,
                             fmt::format("is {:g}; must be above {:g}, where the station before it "
                                         "is",
                                         here.y, read.stations[k - 1].y));
    }
    if (points > kMostLoftPoints)
      fields.refuse(
          "stations", ErrorKind::OutOfRange,
          fmt::format("have {} points in all; must have at most {}", points, kMostLoftPoints));
  };
  return table;
}

Shape<double> outline_length() { return shape::number(above(0.0, kMaxLength)); }
Shape<double> bridge_width() { return shape::number(from(0.0, kMaxLength)); }
constexpr const char* kBridgeHelp =
    "width of the bridges that hold a part in a hole; 0: none; if left out 1/15 of the height";

FieldTable<TextSpec> text_fields() {
  return {{
      needed<TextSpec>("text", &TextSpec::text, shape::text(), "one line of letters"),
      field<TextSpec>("font", &TextSpec::font, file_name(),
                      "name of a TrueType or OpenType file, relative to the spec; if left out "
                      "DejaVu Sans Bold"),
      field<TextSpec>("height", &TextSpec::height, outline_length(), "height of its capitals"),
      field<TextSpec>("depth", &TextSpec::depth, outline_length(), "from the wall to its front"),
      field<TextSpec>("bridge", &TextSpec::bridge, bridge_width(), kBridgeHelp),
  }};
}

FieldTable<OutlineSpec> outline_fields() {
  return {{
      needed<OutlineSpec>("file", &OutlineSpec::file, file_name(),
                          "name of the file, relative to the spec"),
      field<OutlineSpec>("height", &OutlineSpec::height, outline_length(),
                         "height of the whole; if left out as it is drawn, in mm"),
      field<OutlineSpec>("depth", &OutlineSpec::depth, outline_length(),
                         "from the wall to its front"),
      field<OutlineSpec>("bridge", &OutlineSpec::bridge, bridge_width(), kBridgeHelp),
  }};
}

Shape<SurfaceField> surface() {
  const auto positive_triple = shape::blamed(
      shape::triple(above(0.0), "three positive numbers, R1, R2 and R3"), ErrorKind::Malformed);
  const FieldTable<CompositeSpec> composite{{needed<CompositeSpec>(
      "radii", &CompositeSpec::radii, positive_triple, "R1, R2 and R3, where R1 > R3 > R2")}};
  return shape::tagged<SurfaceField>({
      shape::kind<SurfaceField>(
          "revolution",
          FieldTable<RevolutionSpec>{{needed<RevolutionSpec>(
              "radius", &RevolutionSpec::radius, radius(),
              "expression of y, or points that a smooth curve goes through")}},
          "quarter circles about the spine: x^2 + z^2 = radius(y)^2"),
      shape::kind<SurfaceField>(
          "profile",
          FieldTable<ProfileSpec>{{needed<ProfileSpec>(
              "z", &ProfileSpec::z,
              formula_or("[x, z], from the wall to the ground",
                         [](FieldReader& fields, const CurvePoints& read) {
                           check_falls(fields, "points", read);
                         }),
              "expression of x and y, or points of a curve that is the same for each y")}},
          "a profile that falls from the wall to the ground for each y"),
      shape::kind<SurfaceField>(
          "implicit", one_text("f", &ImplicitSpec::f, shape::text(), "expression of x, y and z"),
          "a solid: inside where f(x, y, z) < 0"),
      shape::kind<SurfaceField>(
          "grid",
          one_text("file", &GridSpec::file, file_name(),
                   "name of the CSV file, relative to the spec"),
          "heights over a grid: a CSV file. Its first row holds the x values and its first column "
          "the y values; the cell where they meet is empty"),
      shape::kind<SurfaceField>(
          "mesh",
          one_text("file", &MeshSpec::file, file_name(), "name of the file, relative to the spec"),
          "triangles: an STL or OBJ file"),
      shape::kind<SurfaceField>("text", text_fields(), "letters that stand on the ground"),
      shape::kind<SurfaceField>("outline", outline_fields(),
                                "the closed lines and filled shapes of a drawing, upright: an SVG "
                                "or DXF file"),
      shape::kind<SurfaceField>("loft", loft(),
                                "a surface through falling curves at places along the spine"),
      shape::kind<SurfaceField>("composite", composite,
                                "three regions whose radius runs R1, R2, R3"),
  });
}

// ---- widths and regions

template <typename Widths>
Shape<Widths> fixed_widths() {
  const auto one = shape::as<Widths>(length(), [](double width) { return Widths(width); });
  const auto each = shape::list(length(), {0, kMaxSlices, ErrorKind::OutOfRange},
                                "a list with the width of each slice");
  return shape::either(one, shape::as<Widths>(each, [](std::vector<double> widths) {
                         return Widths(std::move(widths));
                       }));
}

Shape<WidthsField> widths() {
  using Row = AdaptiveWidths;
  const FieldTable<Row> adaptive{{
      needed<Row>("max_error_mm", &Row::max_error_mm, length(),
                  "largest distance between the target and its slices: how far the target bulges "
                  "between neighbouring ones"),
      field<Row>("length_mm", &Row::length_mm, length(), "length of the whole along the spine"),
  }};
  const auto chosen =
      shape::as<WidthsField>(shape::object(adaptive, "an object with max_error_mm"),
                             [](const AdaptiveWidths& asked) { return WidthsField(asked); });
  return shape::either(fixed_widths<WidthsField>(), chosen);
}

Shape<int> units() { return shape::whole(1, kMaxUnitsPerSlice); }
Shape<int> slice_count() { return shape::whole(1, kMaxSlices); }

Shape<std::vector<RegionFields>> regions() {
  using Row = RegionFields;
  FieldTable<Row> region{{
      needed<Row>("units_per_slice", &Row::units_per_slice, units(), "pop-up units of each slice"),
      needed<Row>("slices", &Row::slices, slice_count(), "number of slices"),
      field<Row>("radius", &Row::radius, radius(),
                 "radius of a surface of revolution: expression of y, from 0 to L in the region, "
                 "or points that a smooth curve goes through"),
      field<Row>("width_mm", &Row::width_mm, length(), "width of all its slices"),
      field<Row>("widths_mm", &Row::widths_mm, fixed_widths<FixedWidths>(),
                 "one width for all its slices, or a list with one for each slice"),
  }};
  region.clash = [](FieldReader& fields) { check_clash(fields, "width_mm", "widths_mm"); };
  region.check = [](FieldReader& fields, Row& read) {
    if (!read.width_mm && !read.widths_mm)
      fields.need("width_mm", fmt::format("must be a number above 0 and at most {:g}", kMaxLength));
  };
  region.more = {{"oneOf", {{{"required", {"width_mm"}}}, {{"required", {"widths_mm"}}}}}};
  const std::string what = fmt::format(
      "a list of 1 to {} regions, such as [{{\"units_per_slice\": 3, \"slices\": 5, "
      "\"width_mm\": 10}}]",
      kMostRegions);
  return shape::list(shape::object(region, "an object"), {1, kMostRegions, ErrorKind::Malformed},
                     what);
}

// ---- splay

Shape<AlphaField> alpha() {
  const auto tangent = shape::number(from(0.0, kMostAlpha));
  const auto row = shape::list(tangent, {0, kMaxSlices, ErrorKind::Malformed},
                               fmt::format("a list of numbers from 0 to {:g}, one for each "
                                           "connector",
                                           kMostAlpha));
  const auto rows = shape::list(shape::blamed(row, ErrorKind::Malformed),
                                {1, kMaxUnitsPerSlice, ErrorKind::Malformed},
                                "a list of them for each inner level");
  return shape::either(shape::as<AlphaField>(shape::blamed(tangent, ErrorKind::Malformed),
                                             [](double a) { return AlphaField(a); }),
                       shape::as<AlphaField>(rows, [](std::vector<std::vector<double>> a) {
                         return AlphaField(std::move(a));
                       }));
}

Shape<std::vector<TargetFields>> splay_targets() {
  using Row = TargetFields;
  FieldTable<Row> target{{
      needed<Row>("psi_rad", &Row::psi_rad, shape::number(above(0.0, std::numbers::pi)),
                  "opening angle, from 0 (shut) to pi (flat)"),
      field<Row>("K", &Row::K_rad, shape::number(from(-20.0, kRightSum)),
                 "angle defect at the middle fold vertex, rad"),
      field<Row>("sign", &Row::sign_text, shape::any({{"enum", {"+", "-"}}}, "\"+\" or \"-\""),
                 "sign of the angle defect, in place of K"),
      field<Row>("margin_rad", &Row::margin_rad, shape::number(from(0.0, kRightSum)),
                 "how far from 0 a defect with a sign is at least"),
  }};
  target.check = [](FieldReader& fields, Row& read) {
    const bool plus = read.sign_text == json("+"), minus = read.sign_text == json("-");
    if (read.K_rad.has_value() == (plus || minus) || (read.sign_text && !plus && !minus))
      fields.refuse(ErrorKind::Malformed, "needs either \"K\" (rad) or \"sign\": \"+\" or \"-\"");
    read.sign = plus ? 1 : minus ? -1 : 0;
  };
  target.more = {{"oneOf", {{{"required", {"K"}}}, {{"required", {"sign"}}}}}};
  return shape::list(shape::object(target, "an object"), {1, 3, ErrorKind::Malformed},
                     "a list of one to three targets, since three splays are solved for");
}

Shape<SplayFields> splay() {
  using Row = SplayFields;
  FieldTable<Row> table{{
      field<Row>("alpha", &Row::alpha_field, alpha(),
                 "tangent of the splay angle: one number, or a list for each inner level with a "
                 "number for each connector (0: no V-fold)"),
      field<Row>("targets", &Row::target_fields, splay_targets(),
                 "in place of alpha: what the middle fold vertex does at one to three opening "
                 "angles"),
      field<Row>("length_mm", &Row::length_mm, length(),
                 "length of a V-fold along its crease; as long as the connector allows if left "
                 "out"),
      field<Row>(
          "ligament_mm", &Row::given_ligament_mm, shape::number(from(0.0, kMaxLength), "mm"),
          "paper left beside V-folds; if left out 1, min_panel_mm, or the shortest fold that "
          "the material dashes well, whichever is most"),
  }};
  table.clash = [](FieldReader& fields) { check_clash(fields, "alpha", "targets"); };
  table.check = [](FieldReader& fields, Row& read) {
    if (!read.alpha_field && !read.target_fields)
      fields.need("alpha", fmt::format("must be a number from 0 to {:g}, or a list of them for "
                                       "each inner level",
                                       kMostAlpha));
  };
  table.more = {{"oneOf", {{{"required", {"alpha"}}}, {{"required", {"targets"}}}}}};
  return shape::object(table, "an object");
}

// ---- curvature

/// One value for all inner vertices, or a list with one for each.
template <typename Value>
Shape<std::vector<Value>> for_vertices(const Shape<Value>& one, const std::string& what) {
  return shape::either(shape::as<std::vector<Value>>(
                           one, [](const Value& value) { return std::vector<Value>{value}; }),
                       shape::list(one, {1, kMostTargets, ErrorKind::OutOfRange}, what));
}

Shape<std::vector<double>> curvatures() {
  return for_vertices(shape::number(from(-kMostCurvature, kMostCurvature)),
                      "a list with a number for each inner vertex");
}

Shape<std::vector<std::array<double, 3>>> forms() {
  auto form = shape::triple(from(-kMostForm, kMostForm), "[ss, st, tt], a list of three numbers");
  form.takes = [](const json& value) {
    return value.is_array() && (value.empty() || !value.front().is_array());
  };
  return for_vertices(form, "a list with one for each inner vertex");
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
void set_weights(FieldReader& fields, CurvatureFields& read) {
  const WeightFields given = read.weights.value_or(WeightFields{});
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

Shape<CurvatureFields> curvature() {
  using Weight = WeightFields;
  auto weight = shape::number(from(0.0, kMostWeight));
  weight.schema["default"] = 1;  // where its curvature is given
  const FieldTable<Weight> weights{{
      field<Weight>("K", &Weight::K, weight, "weight of K_area"),
      field<Weight>("H", &Weight::H, weight, "weight of H"),
      field<Weight>("first", &Weight::first, weight, "weight of first"),
      field<Weight>("second", &Weight::second, weight, "weight of second"),
  }};
  using Row = CurvatureFields;
  FieldTable<Row> table{{
      field<Row>("K_area", &Row::K_area, curvatures(), "Gaussian curvature, 1/mm^2"),
      field<Row>("H", &Row::H, curvatures(), "mean curvature, 1/mm, above 0 where convex"),
      field<Row>("first", &Row::first, forms(),
                 "first fundamental form [a_ss, a_st, a_tt], mm^2: s along a slice, t across "
                 "slices"),
      field<Row>("second", &Row::second, forms(), "second fundamental form [b_ss, b_st, b_tt], mm"),
      field<Row>("weights", &Row::weights, shape::object(weights, "an object"),
                 "how much each of them counts"),
  }};
  table.check = [](FieldReader& fields, Row& read) {
    if (read.K_area.empty() && read.H.empty() && read.first.empty() && read.second.empty())
      return fields.refuse(ErrorKind::Malformed,
                           "asks for nothing; give K_area, H, first or second");
    const std::size_t before = fields.faults().size();
    check_forms(fields, read);
    if (fields.faults().size() == before) set_weights(fields, read);
  };
  table.more = {{"anyOf",
                 {{{"required", {"K_area"}}},
                  {{"required", {"H"}}},
                  {{"required", {"first"}}},
                  {{"required", {"second"}}}}}};
  return shape::object(table, "an object");
}

// ---- facets

Shape<FacetFields> facets() {
  using Row = FacetFields;
  const auto cost = shape::number(from(0.0, kMostWeight), "mm^2");
  const FieldTable<Row> table{{
      field<Row>("pitch_mm", &Row::pitch_mm, shape::number(from(0.1, kMaxLength), "mm"),
                 "distance between the planes that are tried; planes in which much of the target "
                 "lies are tried too"),
      field<Row>("strip_mm", &Row::strip_mm, shape::number(from(0.1, kMaxLength), "mm"),
                 "width of a strip: contours are that fine along the spine"),
      field<Row>("from_mm", &Row::given_from_mm, shape::number(from(-kMaxLength, kMaxLength), "mm"),
                 "where it begins along the spine; if left out where a mesh, grid, text or drawing "
                 "does, else "
                 "at 0"),
      field<Row>("length_mm", &Row::length_mm, length(),
                 "length along the spine; if left out all of a mesh, grid, text or drawing"),
      field<Row>("fold_cost_mm2", &Row::fold_cost_mm2, cost,
                 "what a fold costs for each mm of its length: as much as this area 1 mm off the "
                 "target. More makes fewer folds"),
      field<Row>("jump_cost_mm2", &Row::jump_cost_mm2, cost, "the same of a cut along the spine"),
      field<Row>("cut_cost_mm2", &Row::cut_cost_mm2, cost,
                 "the same of a cut across the spine. More makes larger patches"),
      field<Row>("curved", &Row::curved, shape::word<CurvedParts>({"lattice", "facets"}),
                 "how curved parts hold. lattice: by panels in planes of their own from strip to "
                 "strip, which are moved to where the target is; facets: by struts, as planar "
                 "parts do"),
      field<Row>("inward", &Row::inward, shape::boolean(),
                 "true: parts of the target behind wall and ground are made too, where nothing is "
                 "in front of them"),
  }};
  return shape::object(table, "an object");
}

// ---- what is shared, and the patches

Shape<std::optional<CardSpec>> card() {
  using Row = CardSpec;
  using Card = std::optional<CardSpec>;
  const FieldTable<Row> table{{
      field<Row>("wall_mm", &Row::wall_mm, length(),
                 "height of the wall, H; if left out, 15 above the highest fold, and large enough "
                 "for shut"),
      field<Row>(
          "ground_mm", &Row::ground_mm, length(),
          "depth of the ground, D; if left out, 15 beyond the farthest fold, and large enough "
          "for shut"),
      field<Row>("margin_mm", &Row::margin_mm, shape::number(from(0.1, kMaxLength), "mm"),
                 "width of the plain strips at both sides, and of the card around the shut "
                 "structure"),
      field<Row>("shut", &Row::shut, shape::word<CardShut>({"inside", "free"}),
                 "inside: the shut structure lies inside the card; free: it may stick out"),
  }};
  Shape<Card> with = shape::as<Card>(
      shape::boolean(), [](bool is_there) { return is_there ? Card(CardSpec{}) : Card(); });
  with.what = "false";
  return shape::either(
      with,
      shape::as<Card>(shape::object(table, "an object with wall_mm, ground_mm, margin_mm, shut"),
                      [](const CardSpec& read) { return Card(read); }));
}

/// A paper by its name, or [width, height].
Shape<std::optional<SheetSpec>> sheet() {
  using Sheet = std::optional<SheetSpec>;
  std::vector<std::string> names;
  for (const Paper& paper : kPapers) names.emplace_back(paper.name);
  const auto which = shape::blamed(shape::text(), ErrorKind::Malformed);
  Shape<Sheet> named = shape::as<Sheet>(which, [](const std::string&) { return Sheet(); });
  named.schema = {{"enum", names}};
  named.what = fmt::format("one of {}", fmt::join(names, ", "));
  named.read = [names](FieldReader& fields, const std::string& below, const json& value) {
    std::optional<Sheet> out;
    if (const auto index = fields.word_at(below, value, names)) {
      const Paper& paper = kPapers[*index];
      out = SheetSpec{paper.name, paper.width_mm, paper.height_mm};
    }
    return out;
  };
  const auto sides = shape::list(length(), {2, 2, ErrorKind::Malformed}, "[width, height] in mm");
  return shape::either(named, shape::as<Sheet>(sides, [](const std::vector<double>& mm) {
                         return Sheet(SheetSpec{"", mm[0], mm[1]});
                       }));
}

Shape<std::optional<double>> number_or_null(const shape::Range& range) {
  const auto number = shape::number(range);
  Shape<std::optional<double>> out = shape::as<std::optional<double>>(
      number, [](double value) { return std::optional<double>(value); });
  out.schema["type"] = {"number", "null"};
  out.takes = [](const json& value) { return value.is_number() || value.is_null(); };
  out.read = [read = out.read](FieldReader& fields, const std::string& below, const json& value) {
    using Number = std::optional<double>;
    return value.is_null() ? std::optional<Number>(std::in_place) : read(fields, below, value);
  };
  out.written = [](const std::optional<double>& value) { return value ? json(*value) : json(); };
  return out;
}

Shape<JoinField> joins() {
  auto word =
      shape::blamed(shape::word<PatchJoin>({"auto", "sheet", "seam"}), ErrorKind::Malformed);
  const auto each = shape::list(word, {1, kMostPatches - 1, ErrorKind::OutOfRange},
                                "a list with a word for each border");
  auto one = shape::as<JoinField>(word, [](PatchJoin join) { return JoinField(join); });
  one.written = [](const JoinField&) { return json("auto"); };
  return shape::either(one, shape::as<JoinField>(each, [](std::vector<PatchJoin> all) {
                         return JoinField(std::move(all));
                       }));
}

Shape<BookSpec> book() {
  const FieldTable<BookSpec> table{{
      needed<BookSpec>("cards", &BookSpec::cards, shape::whole(kLeastCards, kMostCards),
                       "how many; each is open to 360 degrees by this number"),
  }};
  return shape::object(table, "an object with cards");
}

SpecTables make_tables() {
  using Row = SpecFields;
  SpecTables all;
  all.whole.rows = {
      needed<Row>("popcut", &Row::version, shape::whole(1, 1), "version of this format"),
      field<Row>("material", &Row::material, shape::text(), "name of the material"),
      field<Row>("pen", &Row::pens, shape::text(),
                 "settings of the tool in place of the material's, as --pen of popcut plan gives "
                 "them: \"cut: force=90; outline: passes=2\""),
      field<Row>("sheet", &Row::sheet, sheet(),
                 "what it is cut from, to be warned of a pattern that is larger: a paper by its "
                 "name, or [width, height] in mm"),
      field<Row>(
          "design_angle_deg", [](auto& row) -> auto& { return row.placement.design_angle_deg; },
          shape::number(from(kLeastDesignAngle, kMostDesignAngle)),
          "opening angle of the card, between wall and ground, at which the structure shows the "
          "target"),
      field<Row>("book", &Row::book, book(),
                 "a book of cards around one spine, glued back to back, that shows the target from "
                 "all sides. In a book fit is nearest if left out; a mesh without rotate_deg has "
                 "its z axis along the spine, one without translate_mm its middle there"),
  };
  all.name.rows = {field<Row>("name", &Row::name, shape::text(), "name of the design")};
  all.shared.rows = {
      field<Row>("fit", &Row::fit, shape::word<FitMode>({"exact", "nearest"}),
                 "what becomes of parts that no curve falling from wall to ground can follow: an "
                 "error, or the nearest curve that falls"),
      field<Row>(
          "lattice", &Row::lattice,
          shape::word<LatticeMethod>(
              {"branching", "slices", "conformal", "levels", "direct", "auto"}),
          "how the levels of neighbouring slices are paired, auto: the way that comes nearest "
          "to the target; if left out auto, \"slices\" beside curvature, \"conformal\" "
          "beside splay"),
      field<Row>("solver", &Row::solver, shape::word<SolverMethod>({"newton", "slsqp"}),
                 "how the pop-up units of a slice are fitted to the target"),
      field<Row>("card", &Row::card, card(),
                 "wall, ground and margins around the design; false leaves them out"),
      field<Row>("min_panel_mm", &Row::given_min_panel_mm, length(),
                 "smallest panel, along the strip; if left out 0.5, or 3 times the thickness of "
                 "the material if that is more"),
      field<Row>("max_step_over_mean", &Row::max_step_over_mean, number_or_null(above(1.0, 1e6)),
                 "largest step of a conformal lattice over the mean one; null: no limit"),
  };
  all.design.rows = {
      field<Row>("style", &Row::style, shape::word<DesignStyle>({"lattice", "facets"}),
                 "what it is made of: lattice, slices of falling staircases; facets, origamic "
                 "architecture: patches parallel to wall and ground, with cuts along contours"),
      field<Row>("facets", &Row::facet_fields, facets(),
                 "in place of units_per_slice, slices, widths_mm and regions, beside \"style\": "
                 "\"facets\""),
      field<Row>("surface", &Row::surface_field, surface(), "the target"),
      field<Row>(
          "scale_mm", [](auto& row) -> auto& { return row.placement.scale_mm; }, length(),
          "length of one unit of the surface"),
      field<Row>(
          "rotate_deg", [](auto& row) -> auto& { return row.placement.rotate_deg; },
          shape::triple(from(-3600.0, 3600.0), "a list of three numbers [x, y, z]"),
          "turns of the scaled surface about the x, then the y, then the z axis; x points "
          "away from the wall, y along the spine, z up"),
      field<Row>(
          "translate_mm", [](auto& row) -> auto& { return row.placement.translate_mm; },
          shape::triple(from(-kMaxLength, kMaxLength), "a list of three numbers [x, y, z]"),
          "shift of the scaled and turned surface"),
      field<Row>("regions", &Row::region_fields, regions(),
                 "in place of units_per_slice, slices and widths_mm: stretches along the spine, "
                 "each with its own"),
      field<Row>("units_per_slice", &Row::units_per_slice, units(), "pop-up units of each slice"),
      field<Row>("slices", &Row::slices, slice_count(),
                 "number of slices; the largest number where widths_mm has max_error_mm and "
                 "length_mm"),
      field<Row>("widths_mm", &Row::widths_field, widths(),
                 "one width for all slices, a list with one for each slice, or an object: widths "
                 "chosen from the target's curvature"),
      field<Row>("splay", &Row::splay_fields, splay(),
                 "V-folds on the valley creases of the connectors"),
      field<Row>("curvature", &Row::curvature_fields, curvature(),
                 "curvature that the surface through the fold vertices must have: one value for "
                 "all inner vertices, or a list with one for each. The list holds levels 1 to "
                 "units - 1 of the second slice, then of the third, up to the last but one"),
  };
  all.patches.rows = {
      needed<Row>("patches", &Row::patch_fields,
                  shape::list(shape::any(json::object(), "a design"),
                              {2, kMostPatches, ErrorKind::Malformed},
                              fmt::format("a list of 2 to {} designs", kMostPatches)),
                  "designs that are joined one after another along the spine. Each has the fields "
                  "of a design except popcut and material. card, fit, lattice, solver, "
                  "min_panel_mm and max_step_over_mean beside patches are the defaults of those"),
      field<Row>("join", &Row::join_field, joins(),
                 "auto: one sheet where walls and grounds agree, else a seam; sheet: one sheet or "
                 "an error; seam: separate patterns that are glued. One word for all borders, or "
                 "a list"),
      field<Row>("join_tolerance_mm", &Row::join_tolerance_mm,
                 shape::number(from(0.0, kMaxLength), "mm"),
                 "largest distance between the profiles of two edges that are joined"),
  };
  return all;
}

}  // namespace

const SpecTables& spec_tables() {
  static const SpecTables tables = make_tables();
  return tables;
}

}  // namespace popcut

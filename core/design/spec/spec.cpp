// SPDX-License-Identifier: MIT
#include "core/design/spec/spec.hpp"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "core/design/spec/augmented_fields.hpp"
#include "core/design/spec/patches_spec.hpp"
#include "core/design/target/surface_fields.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr double kMaxLength = 1e5;  ///< 100 m: no sheet is larger

Result<std::optional<CardSpec>> parse_card(const json* value) {
  if (!value || (value->is_boolean() && value->get<bool>())) return CardSpec{};
  if (value->is_boolean()) return std::optional<CardSpec>{};
  if (!value->is_object())
    return fail(
        ErrorKind::Malformed, "/card",
        fmt::format("is {}; false or an object with wall_mm, ground_mm, margin_mm is needed",
                    json_type(*value)));
  FieldReader fields(*value, "/card");
  CardSpec card;
  if (fields.has("wall_mm")) card.wall_mm = fields.number("wall_mm", 0.0, 0.0, kMaxLength, true);
  if (fields.has("ground_mm"))
    card.ground_mm = fields.number("ground_mm", 0.0, 0.0, kMaxLength, true);
  (void)fields.value("wall_mm");
  (void)fields.value("ground_mm");
  card.margin_mm = fields.number("margin_mm", card.margin_mm, 0.01, kMaxLength);
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return std::optional<CardSpec>{card};
}

Result<std::vector<double>> parse_widths(const json* value, int slices,
                                         const std::string& field = "/widths_mm") {
  const auto lawful = [](const json& w) {
    return w.is_number() && w.get<double>() > 0.0 && w.get<double>() <= kMaxLength;
  };
  const auto wrong = [](const json& w, const std::string& place) {
    return fail(w.is_number() ? ErrorKind::OutOfRange : ErrorKind::Malformed, place,
                fmt::format("is {}; a width above 0 and at most {:g} mm is needed",
                            w.is_number() ? fmt::format("{:g}", w.get<double>()) : json_type(w),
                            kMaxLength));
  };
  if (!value)
    return fail(ErrorKind::Malformed, field, "is missing; a number or a list of numbers is needed");
  if (!value->is_array()) {
    if (!lawful(*value)) return wrong(*value, field);
    return std::vector<double>(static_cast<std::size_t>(slices), value->get<double>());
  }
  std::vector<double> widths;
  for (std::size_t j = 0; j < value->size(); ++j) {
    if (!lawful((*value)[j])) return wrong((*value)[j], fmt::format("{}/{}", field, j));
    widths.push_back((*value)[j].get<double>());
  }
  if (widths.size() != static_cast<std::size_t>(slices))
    return fail(ErrorKind::OutOfRange, field,
                fmt::format("has {} widths for {} slices; one a slice or a single number is needed",
                            widths.size(), slices));
  return widths;
}

Result<std::vector<CurvatureTarget>> parse_targets(const json& value) {
  if (!value.is_array() || value.empty() || value.size() > 3)
    return fail(ErrorKind::Malformed, "/splay/targets",
                fmt::format("is {}; a list of one to three targets is needed, since three splays "
                            "are solved for",
                            value.is_array() ? fmt::format("a list of {}", value.size())
                                             : json_type(value)));
  std::vector<CurvatureTarget> targets;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const std::string place = fmt::format("/splay/targets/{}", k);
    FieldReader fields(value[k], place);
    CurvatureTarget target;
    target.psi_rad = fields.number("psi_rad", std::nullopt, 0.0, std::numbers::pi, true);
    if (fields.has("K"))
      target.K_rad = fields.number("K", std::nullopt, -20.0, 2.0 * std::numbers::pi);
    (void)fields.value("K");
    const json* sign = fields.value("sign");
    target.margin_rad = fields.number("margin_rad", target.margin_rad, 0.0, 2.0 * std::numbers::pi);
    if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
    const bool plus = sign && *sign == "+", minus = sign && *sign == "-";
    if (target.K_rad.has_value() == (plus || minus) || (sign && !plus && !minus))
      return fail(ErrorKind::Malformed, place,
                  "needs either \"K\" (rad) or \"sign\": \"+\" or \"-\"");
    target.sign = plus ? 1 : minus ? -1 : 0;
    targets.push_back(target);
  }
  return targets;
}

Result<SplaySpec> parse_splay(const json& value, double min_panel_mm) {
  FieldReader fields(value, "/splay");
  SplaySpec splay;
  constexpr double kMostAlpha = 1000.0;
  const auto lawful = [](const json& a) {
    return a.is_number() && a.get<double>() >= 0.0 && a.get<double>() <= kMostAlpha;
  };
  const json* alpha = fields.value("alpha");
  const json* targets = fields.value("targets");
  splay.ligament_mm = fields.number("ligament_mm", std::max(1.0, min_panel_mm), 0.0, kMaxLength);
  if (fields.has("length_mm"))
    splay.length_mm = fields.number("length_mm", std::nullopt, 0.0, kMaxLength, true);
  (void)fields.value("length_mm");
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  if (targets) {
    if (alpha)
      return fail(ErrorKind::Malformed, "/splay/alpha",
                  "contradicts /splay/targets; give one or the other");
    auto parsed = parse_targets(*targets);
    if (!parsed) return tl::unexpected(parsed.error());
    splay.targets = std::move(*parsed);
    return splay;
  }
  if (alpha && lawful(*alpha)) {
    splay.uniform = alpha->get<double>();
    return splay;
  }
  if (!alpha || !alpha->is_array() || alpha->empty())
    return fail(
        ErrorKind::Malformed, "/splay/alpha",
        fmt::format("must be a number from 0 to {:g}, or a row of them for each inner level",
                    kMostAlpha));
  for (std::size_t i = 0; i < alpha->size(); ++i) {
    const json& row = (*alpha)[i];
    if (!row.is_array() || !std::all_of(row.begin(), row.end(), lawful))
      return fail(
          ErrorKind::Malformed, fmt::format("/splay/alpha/{}", i),
          fmt::format("must be a list of numbers from 0 to {:g}, one a connector", kMostAlpha));
    splay.alpha.push_back(row.get<std::vector<double>>());
  }
  return splay;
}

/// The paper's composite (S2.F): three stretches whose radius runs R1 -> R2 -> R3 -> R2 by its
/// three formulas, each over the length L of its own region.
Result<std::vector<std::string>> composite_radii(const json& surface) {
  FieldReader fields(surface, "/surface");
  (void)fields.text("type", "composite");
  const json* radii = fields.value("radii");
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  const auto lawful = [](const json& r) { return r.is_number() && r.get<double>() > 0.0; };
  if (!radii || !radii->is_array() || radii->size() != 3 ||
      !std::all_of(radii->begin(), radii->end(), lawful))
    return fail(ErrorKind::Malformed, "/surface/radii",
                "must be three positive numbers, R1, R2 and R3");
  const double r1 = (*radii)[0], r2 = (*radii)[1], r3 = (*radii)[2];
  if (!(r1 > r3 && r3 > r2))
    return fail(ErrorKind::OutOfRange, "/surface/radii",
                fmt::format("are {:g}, {:g}, {:g}; R1 > R3 > R2 is needed", r1, r2, r3));
  return std::vector<std::string>{
      fmt::format("{0} + ({1} - {0})*0.5*(1 + cos(pi*(y/L - 1)))", r1, r2),
      fmt::format("{0} + ({1} - {0})*0.5*(1 + sin(pi*(y/L - 0.5)))", r2, r3),
      fmt::format("{0} + ({1} - {0})*0.5*(1 - cos(pi*y/L))", r3, r2)};
}

/// `regions`: each has its own units, slices and width, and may have its own radius.
Result<void> parse_regions(const json& value, DesignSpec& spec) {
  if (!value.is_array() || value.empty() || value.size() > 1000)
    return fail(ErrorKind::Malformed, "/regions",
                fmt::format("is {}; a list of 1 to 1000 regions is needed, such as "
                            "[{{\"units_per_slice\": 3, \"slices\": 5, \"width_mm\": 10}}]",
                            value.is_array() ? fmt::format("a list of {}", value.size())
                                             : json_type(value)));
  long slices = 0;
  for (std::size_t r = 0; r < value.size(); ++r) {
    FieldReader fields(value[r], fmt::format("/regions/{}", r));
    RegionSpec region;
    region.units_per_slice = fields.integer("units_per_slice", std::nullopt, 1, kMaxUnitsPerSlice);
    region.slices = fields.integer("slices", std::nullopt, 1, kMaxSlices);
    const json* list = fields.value("widths_mm");
    const std::string width_field = fields.pointer(list ? "widths_mm" : "width_mm");
    if (list && fields.has("width_mm"))
      return fail(ErrorKind::Malformed, fields.pointer("width_mm"),
                  fmt::format("contradicts {}; give one or the other", width_field));
    if (list && list->is_object())
      return fail(
          ErrorKind::Malformed, width_field,
          "is an object; widths are chosen from the target only where there are no regions, "
          "so a number or a list is needed");
    const double width =
        list ? 0.0 : fields.number("width_mm", std::nullopt, 0.0, kMaxLength, true);
    if (fields.has("radius")) region.radius = fields.text("radius", std::nullopt);
    (void)fields.value("radius");
    if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
    if ((slices += region.slices) > kMaxSlices)
      return fail(
          ErrorKind::OutOfRange, fmt::format("/regions/{}/slices", r),
          fmt::format("makes {} slices in all; at most {} are designed", slices, kMaxSlices));
    auto widths = list ? parse_widths(list, region.slices, width_field)
                       : std::vector<double>(static_cast<std::size_t>(region.slices), width);
    if (!widths) return tl::unexpected(widths.error());
    spec.widths_mm.insert(spec.widths_mm.end(), widths->begin(), widths->end());
    spec.regions.push_back(std::move(region));
  }
  return {};
}

/// The target and its slices: `surface` with `regions`, or with `units_per_slice`, `slices` and
/// `widths_mm` for one region.
Result<void> parse_target(const json& root, FieldReader& fields, DesignSpec& spec) {
  const json* surface = fields.value("surface");
  const json* regions = fields.value("regions");
  const json* widths = fields.value("widths_mm");
  if (regions) {
    for (const char* single : {"units_per_slice", "slices", "widths_mm"})
      if (fields.value(single))
        return fail(ErrorKind::Malformed, fields.pointer(single),
                    "contradicts /regions, which have their own; give one or the other");
    if (auto parsed = parse_regions(*regions, spec); !parsed) return parsed;
  } else {
    const int units = fields.integer("units_per_slice", std::nullopt, 1, kMaxUnitsPerSlice);
    const int slices = fields.integer("slices", std::nullopt, 1, kMaxSlices);
    spec.regions.push_back({units, slices, std::nullopt});
  }
  if (auto done = fields.finish(); !done) return done;
  if (!regions && widths && widths->is_object()) {
    FieldReader adaptive(*widths, "/widths_mm");
    AdaptiveWidths asked;
    asked.max_error_mm = adaptive.number("max_error_mm", std::nullopt, 0.0, kMaxLength, true);
    if (adaptive.has("length_mm"))
      asked.length_mm = adaptive.number("length_mm", std::nullopt, 0.0, kMaxLength, true);
    (void)adaptive.value("length_mm");
    if (auto done = adaptive.finish(); !done) return done;
    spec.adaptive = asked;
  } else if (!regions) {
    auto parsed = parse_widths(widths, spec.regions.front().slices);
    if (!parsed) return tl::unexpected(parsed.error());
    spec.widths_mm = std::move(*parsed);
  }
  long units = 0;
  for (const RegionSpec& region : spec.regions)
    units += static_cast<long>(region.units_per_slice) * region.slices;
  if (units > kMaxUnits)
    return fail(ErrorKind::OutOfRange, regions ? "/regions" : "/slices",
                fmt::format("the slices have {} units in all; at most {} are designed in one go",
                            units, kMaxUnits));
  if (surface && surface->is_object() && surface->value("type", json()) == "composite") {
    auto radii = composite_radii(*surface);
    if (!radii) return tl::unexpected(radii.error());
    if (spec.regions.size() != 3)
      return fail(ErrorKind::OutOfRange, "/regions",
                  fmt::format("are {}; a composite surface needs three", spec.regions.size()));
    for (std::size_t r = 0; r < 3; ++r) {
      if (spec.regions[r].radius)
        return fail(ErrorKind::Malformed, fmt::format("/regions/{}/radius", r),
                    "contradicts the composite surface, which sets it");
      spec.regions[r].radius = (*radii)[r];
    }
    return {};
  }
  if (surface) {
    auto parsed = parse_surface(*surface, "/surface");
    if (!parsed) return tl::unexpected(parsed.error());
    spec.surface = std::move(*parsed);
    if (std::all_of(spec.regions.begin(), spec.regions.end(),
                    [](const RegionSpec& region) { return region.radius.has_value(); }))
      return fail(ErrorKind::Malformed, "/surface",
                  "contradicts /regions, which all have a radius of their own; leave one out");
    return {};
  }
  for (std::size_t r = 0; r < spec.regions.size(); ++r)
    if (!spec.regions[r].radius)
      return fail(ErrorKind::Malformed,
                  root.contains("regions") ? fmt::format("/regions/{}/radius", r) : "/surface",
                  "is missing; give a surface such as {\"type\": \"revolution\", \"radius\": ...}");
  return {};
}

Result<DesignSpec> parse_design(const json& root);

}  // namespace

Result<DesignSpec> parse_design_spec(std::string_view json_text) {
  constexpr std::size_t kMostBytes = 4u << 20;
  if (json_text.size() > kMostBytes)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("the spec has {} bytes; at most {} are read", json_text.size(), kMostBytes));
  const auto root = parse_json(json_text);
  if (!root) return tl::unexpected(root.error());
  if (root->is_object() && root->contains("patches")) return parse_patches(*root, parse_design);
  return parse_design(*root);
}

namespace {

Result<DesignSpec> parse_design(const json& root) {
  FieldReader fields(root, "");
  DesignSpec spec;
  (void)fields.integer("popcut", std::nullopt, 1, 1);
  spec.name = fields.text("name", spec.name);
  spec.placement = parse_placement(fields);
  spec.fit = static_cast<FitMode>(fields.word("fit", 0, {"exact", "nearest"}));
  spec.lattice = static_cast<LatticeMethod>(fields.word(
      "lattice", fields.has("curvature") ? 1 : 2, {"branching", "slices", "conformal", "levels"}));
  spec.solver = static_cast<SolverMethod>(fields.word("solver", 0, {"newton", "slsqp"}));
  spec.min_panel_mm = fields.number("min_panel_mm", 0.5, 0.0, kMaxLength, true);
  spec.max_step_asked = fields.has("max_step_over_mean");
  if (const json* most = fields.value("max_step_over_mean"); most && most->is_null())
    spec.max_step_over_mean.reset();
  else if (most)
    spec.max_step_over_mean = fields.number("max_step_over_mean", 3.0, 1.0, 1e6, true);
  spec.material = fields.text("material", spec.material);
  const json* card = fields.value("card");
  const json* splay = fields.value("splay");
  const json* curvature = fields.value("curvature");
  if (auto target = parse_target(root, fields, spec); !target)
    return tl::unexpected(target.error());
  for (const RegionSpec& region : spec.regions)
    for (const char* moved : {"rotate_deg", "translate_mm"})
      if (region.radius && fields.has(moved))
        return fail(ErrorKind::Malformed, fields.pointer(moved),
                    "contradicts regions with radii of their own, which stand about the spine");
  if (splay) {
    auto parsed = parse_splay(*splay, spec.min_panel_mm);
    if (!parsed) return tl::unexpected(parsed.error());
    spec.splay = std::move(*parsed);
  }
  if (curvature) {
    auto parsed = parse_augmented(*curvature);
    if (!parsed) return tl::unexpected(parsed.error());
    spec.curvature = std::move(*parsed);
  }
  auto parsed_card = parse_card(card);
  if (!parsed_card) return tl::unexpected(parsed_card.error());
  spec.card = *parsed_card;
  return spec;
}

}  // namespace

std::string design_spec_schema() {
  const auto number = [](const char* text, json more = json::object()) {
    json schema{{"type", "number"}, {"description", text}};
    schema.update(more);
    return schema;
  };
  const json positive{{"exclusiveMinimum", 0}, {"maximum", kMaxLength}};
  json schema{
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "popcut design spec"},
      {"type", "object"},
      {"additionalProperties", false},
      {"required", {"popcut"}},
  };
  json& p = schema["properties"];
  p["popcut"] = {{"const", 1}, {"description", "version of this format"}};
  p["name"] = {{"type", "string"}, {"default", "pattern"}};
  p["surface"] = surface_schema();
  p["surface"]["oneOf"].push_back(
      {{"type", "object"},
       {"description", "three regions whose radius runs R1, R2, R3 (R1 > R3 > R2)"},
       {"additionalProperties", false},
       {"required", {"type", "radii"}},
       {"properties",
        {{"type", {{"const", "composite"}}},
         {"radii", {{"type", "array"}, {"minItems", 3}, {"maxItems", 3}}}}}});
  add_placement_schema(p);
  p["regions"] = {
      {"type", "array"},
      {"description", "instead of units_per_slice, slices and widths_mm: stretches with their own"},
      {"items",
       {{"type", "object"},
        {"additionalProperties", false},
        {"required", {"units_per_slice", "slices"}},
        {"oneOf", {{{"required", {"width_mm"}}}, {{"required", {"widths_mm"}}}}},
        {"properties",
         {{"radius",
           {{"type", "string"}, {"description", "expression of y, 0 to L in the region"}}},
          {"units_per_slice",
           {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxUnitsPerSlice}}},
          {"slices", {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxSlices}}},
          {"width_mm", number("width of its slices", positive)},
          {"widths_mm",
           {{"description", "one width for all its slices, or a list with one a slice"},
            {"oneOf",
             {{{"type", "number"}, {"exclusiveMinimum", 0}, {"maximum", kMaxLength}},
              {{"type", "array"}, {"items", number("width of a slice", positive)}}}}}}}}}}};
  p["units_per_slice"] = {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxUnitsPerSlice}};
  p["slices"] = {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxSlices}};
  p["widths_mm"]["oneOf"] = json::array(
      {number("one width for all slices", positive),
       {{"type", "array"}, {"items", number("width of a slice", positive)}},
       {{"type", "object"},
        {"description", "chosen from the curvature; slices is then how many there are, or at most"},
        {"additionalProperties", false},
        {"required", {"max_error_mm"}},
        {"properties",
         {{"max_error_mm", number("bulge of the target between neighbouring slices", positive)},
          {"length_mm", number("length of the whole along the spine", positive)}}}}});
  p["lattice"] = {{"enum", {"branching", "slices", "conformal", "levels"}},
                  {"default", "conformal"}};
  p["solver"] = {{"enum", {"newton", "slsqp"}}, {"default", "newton"}};
  p["card"]["oneOf"] = json::array(
      {{{"type", "boolean"}, {"description", "false: the lattice alone, without wall and ground"}},
       {{"type", "object"},
        {"additionalProperties", false},
        {"properties",
         {{"wall_mm", number("height of the wall, H", positive)},
          {"ground_mm", number("depth of the ground, D", positive)},
          {"margin_mm", number("plain strips at both sides", positive)}}}}});
  p["min_panel_mm"] = number("smallest panel, along the strip", positive);
  p["min_panel_mm"]["default"] = 0.5;
  p["max_step_over_mean"] = {{"type", {"number", "null"}},
                             {"exclusiveMinimum", 1},
                             {"default", 3},
                             {"description",
                              "largest step of a conformal lattice over the mean one; "
                              "null: no limit"}};
  p["splay"] = {
      {"type", "object"},
      {"description", "V-folds on the valley creases of the connectors"},
      {"additionalProperties", false},
      {"properties",
       {{"targets",
         {{"type", "array"},
          {"description", "instead of alpha, solved at the middle vertex: psi_rad with K or sign"},
          {"minItems", 1},
          {"maxItems", 3}}},
        {"alpha", {{"description", "tan of the splay: one number, or inner levels x connectors"}}},
        {"length_mm",
         number("along the crease; default as long as the connector allows", positive)},
        {"ligament_mm",
         number("paper left beside V-folds; default 1, or min_panel_mm if that is more")}}}};
  add_patches_schema(p);
  p["curvature"] = augmented_schema();
  p["material"] = {{"type", "string"}, {"default", "paper-220"}};
  return schema.dump(2) + "\n";
}

}  // namespace popcut

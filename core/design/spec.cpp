// SPDX-License-Identifier: MIT
#include "core/design/spec.hpp"

#include <fmt/format.h>

#include "core/design/surface_fields.hpp"
#include "core/json_fields.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr double kMaxLength = 1e6;  ///< 1 km: no sheet is larger

Result<std::optional<CardSpec>> parse_card(const json* value) {
  if (!value || (value->is_boolean() && value->get<bool>())) return CardSpec{};
  if (value->is_boolean()) return std::optional<CardSpec>{};
  if (!value->is_object())
    return fail(
        ErrorKind::Malformed, "/card",
        fmt::format("is {}; false or an object with wall_mm, ground_mm, margin_mm is needed",
                    json_type(*value)));
  JsonFields fields(*value, "/card");
  CardSpec card;
  if (fields.has("wall_mm")) card.wall_mm = fields.number("wall_mm", 0.0, 0.0, kMaxLength, true);
  if (fields.has("ground_mm"))
    card.ground_mm = fields.number("ground_mm", 0.0, 0.0, kMaxLength, true);
  (void)fields.value("wall_mm");
  (void)fields.value("ground_mm");
  card.margin_mm = fields.number("margin_mm", card.margin_mm, 0.0, kMaxLength, true);
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return std::optional<CardSpec>{card};
}

Result<std::vector<double>> parse_widths(const json* value, int slices) {
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
    return fail(ErrorKind::Malformed, "/widths_mm",
                "is missing; a number or a list of numbers is needed");
  if (!value->is_array()) {
    if (value->is_object() && value->contains("max_error_mm"))
      return fail(ErrorKind::OutOfRange, "/widths_mm/max_error_mm",
                  "adaptive widths are not built yet; give one width or a list");
    if (!lawful(*value)) return wrong(*value, "/widths_mm");
    return std::vector<double>(static_cast<std::size_t>(slices), value->get<double>());
  }
  std::vector<double> widths;
  for (std::size_t j = 0; j < value->size(); ++j) {
    if (!lawful((*value)[j])) return wrong((*value)[j], fmt::format("/widths_mm/{}", j));
    widths.push_back((*value)[j].get<double>());
  }
  if (widths.size() != static_cast<std::size_t>(slices))
    return fail(ErrorKind::OutOfRange, "/widths_mm",
                fmt::format("has {} widths for {} slices; one a slice or a single number is needed",
                            widths.size(), slices));
  return widths;
}

}  // namespace

Result<DesignSpec> parse_design_spec(std::string_view json_text) {
  constexpr std::size_t kMostBytes = 4u << 20;
  if (json_text.size() > kMostBytes)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("the spec has {} bytes; at most {} are read", json_text.size(), kMostBytes));
  const auto root = parse_json(json_text);
  if (!root) return tl::unexpected(root.error());

  JsonFields fields(*root, "");
  DesignSpec spec;
  (void)fields.integer("popcut", std::nullopt, 1, 1);
  spec.name = fields.text("name", spec.name);
  spec.placement = parse_placement(fields);
  spec.fit = static_cast<FitMode>(fields.word("fit", 0, {"exact", "nearest"}));
  spec.units_per_slice = fields.integer("units_per_slice", std::nullopt, 1, kMaxUnitsPerSlice);
  spec.slices = fields.integer("slices", std::nullopt, 1, kMaxSlices);
  spec.lattice = static_cast<LatticeMethod>(
      fields.word("lattice", 2, {"branching", "slices", "conformal", "levels"}));
  spec.solver = static_cast<SolverMethod>(fields.word("solver", 0, {"newton", "slsqp"}));
  spec.min_panel_mm = fields.number("min_panel_mm", 0.5, 0.0, kMaxLength, true);
  spec.max_step_asked = fields.has("max_step_over_mean");
  if (const json* most = fields.value("max_step_over_mean"); most && most->is_null())
    spec.max_step_over_mean.reset();
  else if (most)
    spec.max_step_over_mean = fields.number("max_step_over_mean", 3.0, 1.0, 1e6, true);
  spec.material = fields.text("material", spec.material);
  for (const char* later : {"regions", "splay"})
    if (fields.value(later))
      fields.add_error(ErrorKind::OutOfRange, fields.pointer(later),
                       "is not built yet in this version of popcut; leave it out");
  const json* surface = fields.value("surface");
  const json* widths = fields.value("widths_mm");
  const json* card = fields.value("card");
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  if (!surface)
    return fail(ErrorKind::Malformed, "/surface",
                "is missing; give {\"type\": \"revolution\", \"radius\": ...}, a profile, an "
                "implicit, a grid or a mesh");
  if (const long units = static_cast<long>(spec.units_per_slice) * spec.slices; units > kMaxUnits)
    return fail(ErrorKind::OutOfRange, "/slices",
                fmt::format("{} slices of {} units are {} units; at most {} are designed in one go",
                            spec.slices, spec.units_per_slice, units, kMaxUnits));

  auto parsed_surface = parse_surface(*surface, "/surface");
  if (!parsed_surface) return tl::unexpected(parsed_surface.error());
  spec.surface = std::move(*parsed_surface);
  auto parsed_widths = parse_widths(widths, spec.slices);
  if (!parsed_widths) return tl::unexpected(parsed_widths.error());
  spec.widths_mm = std::move(*parsed_widths);
  auto parsed_card = parse_card(card);
  if (!parsed_card) return tl::unexpected(parsed_card.error());
  spec.card = *parsed_card;
  return spec;
}

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
      {"required", {"popcut", "surface", "units_per_slice", "slices", "widths_mm"}},
  };
  json& p = schema["properties"];
  p["popcut"] = {{"const", 1}, {"description", "version of this format"}};
  p["name"] = {{"type", "string"}, {"default", "pattern"}};
  p["surface"] = surface_schema();
  add_placement_schema(p);
  p["units_per_slice"] = {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxUnitsPerSlice}};
  p["slices"] = {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxSlices}};
  p["widths_mm"]["oneOf"] =
      json::array({number("one width for all slices", positive),
                   {{"type", "array"}, {"items", number("width of a slice", positive)}}});
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
  p["material"] = {{"type", "string"}, {"default", "paper-220"}};
  return schema.dump(2) + "\n";
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include "core/design/target/surface_fields.hpp"

#include <cmath>

#include <fmt/format.h>

#include "core/text/field_reader.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr double kMaxLength = 1e5;  ///< 100 m: no sheet is larger
constexpr std::size_t kMostNameBytes = 1024;

std::string file_name(FieldReader& fields) {
  std::string name = fields.text("file", std::nullopt);
  if (fields.has("file") &&
      (name.empty() || name.size() > kMostNameBytes || name.find('\0') != std::string::npos))
    fields.refuse(
        "file", ErrorKind::OutOfRange,
        fmt::format("is no file name; one of 1 to {} characters is needed", kMostNameBytes));
  return name;
}

std::array<double, 3> triple(FieldReader& fields, const char* key, double most) {
  std::array<double, 3> out{};
  const json* value = fields.value(key);
  if (!value) return out;
  if (!value->is_array() || value->size() != 3) {
    fields.refuse(key, ErrorKind::Malformed,
                  fmt::format("is {}; a list of three numbers [x, y, z] is needed",
                              value->is_array() ? fmt::format("a list of {}", value->size())
                                                : json_type(*value)));
    return out;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const json& got = (*value)[k];
    const std::string place = fmt::format("{}/{}", key, k);
    if (!got.is_number()) {
      fields.refuse(place, ErrorKind::Malformed,
                    fmt::format("is {}; a number is needed", json_type(got)));
      return out;
    }
    out[k] = got.get<double>();
    if (!(std::abs(out[k]) <= most))
      fields.refuse(
          place, ErrorKind::OutOfRange,
          fmt::format("is {:g}; a number from {:g} to {:g} is needed", out[k], -most, most));
  }
  return out;
}

json kind_schema(const char* type, const char* field, const char* about_kind,
                 const char* about_field) {
  return {
      {"type", "object"},
      {"description", about_kind},
      {"additionalProperties", false},
      {"required", {"type", field}},
      {"properties",
       {{"type", {{"const", type}}}, {field, {{"type", "string"}, {"description", about_field}}}}}};
}

}  // namespace

Result<SurfaceSpec> parse_surface(const json& value, const std::string& pointer) {
  static const std::vector<std::string> kinds{"revolution", "profile", "implicit",
                                              "grid",       "mesh",    "composite"};
  FieldReader fields(value, pointer);
  if (value.is_object() && !value.contains("type"))
    fields.refuse("type", ErrorKind::Malformed,
                  fmt::format("is missing; one of {} is needed", fmt::join(kinds, ", ")));
  SurfaceSpec surface;
  switch (fields.word("type", 0, kinds)) {
    case 0:
      surface = RevolutionSpec{fields.text("radius", std::nullopt)};
      break;
    case 1:
      surface = ProfileSpec{fields.text("z", std::nullopt)};
      break;
    case 2:
      surface = ImplicitSpec{fields.text("f", std::nullopt)};
      break;
    case 3:
      surface = GridSpec{file_name(fields)};
      break;
    case 4:
      surface = MeshSpec{file_name(fields)};
      break;
    default:
      fields.refuse("type", ErrorKind::OutOfRange,
                    "is \"composite\", which stands only at the top of a spec");
  }
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return surface;
}

TargetPlacement parse_placement(FieldReader& fields) {
  TargetPlacement placement;
  placement.scale_mm = fields.number("scale_mm", 1.0, 0.0, kMaxLength, true);
  placement.rotate_deg = triple(fields, "rotate_deg", 3600.0);
  placement.translate_mm = triple(fields, "translate_mm", kMaxLength);
  return placement;
}

json surface_schema() {
  return {{"oneOf",
           json::array(
               {kind_schema("revolution", "radius",
                            "quarter circles about the spine: x^2 + z^2 = radius(y)^2",
                            "expression of y"),
                kind_schema("profile", "z",
                            "a profile that falls from the wall to the ground for each y",
                            "expression of x and y"),
                kind_schema("implicit", "f", "a solid: inside where f(x, y, z) < 0",
                            "expression of x, y and z"),
                kind_schema("grid", "file",
                            "heights over a grid: a CSV file whose first row holds the x values, "
                            "whose first column the y values, the cell where they meet left empty",
                            "name of the CSV file, relative to the spec"),
                kind_schema("mesh", "file", "triangles: an STL or OBJ file",
                            "name of the file, relative to the spec")})}};
}

void add_placement_schema(json& p) {
  p["scale_mm"] = {{"type", "number"},
                   {"description", "mm that one unit of the surface is"},
                   {"exclusiveMinimum", 0},
                   {"maximum", kMaxLength},
                   {"default", 1.0}};
  const auto three = [](const char* text, double most) {
    return json{{"type", "array"},
                {"description", text},
                {"items", {{"type", "number"}, {"minimum", -most}, {"maximum", most}}},
                {"minItems", 3},
                {"maxItems", 3},
                {"default", {0, 0, 0}}};
  };
  p["rotate_deg"] = three(
      "turns of the scaled surface about the x, then the y, then the z axis; x points away from "
      "the wall, y along the spine, z up",
      3600.0);
  p["translate_mm"] = three("shift of the scaled and turned surface", kMaxLength);
  p["fit"] = {{"enum", {"exact", "nearest"}},
              {"default", "exact"},
              {"description",
               "what becomes of parts that no curve falling from wall to ground can follow: an "
               "error, or the nearest curve that falls"}};
}

}  // namespace popcut

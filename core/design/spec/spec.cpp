// SPDX-License-Identifier: MIT
#include "core/design/spec/spec.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/design/spec/spec_table.hpp"
#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr std::array kOneRegion{"units_per_slice", "slices", "widths_mm"};

/// The rules between the fields of one design. Each step adds at most one fault to `fields` and
/// says whether the next one can follow.
class Design {
 public:
  Design(FieldReader& fields, SpecFields& spec) : fields_(fields), spec_(spec) {}

  bool complete() {
    set_min_panel();
    if (spec_.style == DesignStyle::Layers) return check_layers();
    if (spec_.style == DesignStyle::Slices)
      return check_solid("slices need a solid, and a formula or a grid has no inside");
    if (spec_.style == DesignStyle::Boxes)
      return check_solid("boxes need walls, and a formula or a grid does not say where these end");
    if (spec_.book && !set_book()) return false;
    if (is_of_facets(spec_.style)) return check_facet_surface() && set_facets();
    set_splay();
    set_lattice();
    return set_regions() && set_widths() && check_units() && set_surface() && check_placement();
  }

 private:
  bool wrong(const std::string& key, ErrorKind kind, std::string detail) {
    fields_.refuse(key, kind, std::move(detail));
    return false;
  }

  /// What a book's cards have in common: their angle, and one page for all.
  bool set_book() {
    for (const char* one : {"design_angle_deg", "curvature"})
      if (fields_.has(one))
        return wrong(one, ErrorKind::Malformed,
                     fmt::format("contradicts {}, whose cards are open to {:g} degrees; leave it "
                                 "out",
                                 fields_.pointer("book"), spec_.book->angle_deg()));
    if (is_of_facets(spec_.style) && spec_.book->cards != 4)
      return wrong("book/cards", ErrorKind::OutOfRange,
                   fmt::format("is {}; facets are made for 90 degrees only, so it must be 4",
                               spec_.book->cards));
    if (!spec_.card)
      return wrong("card", ErrorKind::Malformed,
                   "is false; a book is glued together at wall and ground, so leave it out");
    if (spec_.card->shut == CardShut::Free)
      return wrong("card/shut", ErrorKind::Malformed,
                   "is \"free\"; a book lies inside its pages when it is shut, so leave it out");
    if (spec_.widths.adaptive)
      return wrong("widths_mm", ErrorKind::Malformed,
                   "would differ from card to card; must be a number or a list of numbers in a "
                   "book");
    spec_.placement.design_angle_deg = spec_.book->angle_deg();
    spec_.book->is_turned = fields_.has("rotate_deg");
    spec_.book->is_moved = fields_.has("translate_mm");
    if (!fields_.has("fit")) spec_.fit = FitMode::Nearest;
    return true;
  }

  bool set_regions() {
    if (spec_.region_fields.empty()) {
      spec_.regions.push_back({*spec_.units_per_slice, *spec_.slices, std::nullopt});
      return true;
    }
    std::int64_t slices = 0;
    for (std::size_t r = 0; r < spec_.region_fields.size(); ++r) {
      const RegionFields& region = spec_.region_fields[r];
      if ((slices += region.slices) > kMaxSlices)
        return wrong(
            fmt::format("regions/{}/slices", r), ErrorKind::OutOfRange,
            fmt::format("makes {} slices in all; must make at most {}", slices, kMaxSlices));
      if (!add_widths(region.widths, region.slices, fmt::format("regions/{}/widths_mm", r)))
        return false;
      spec_.regions.push_back(region);
    }
    return true;
  }

  /// One width for `slices` slices, or a list of as many.
  bool add_widths(const WidthFields& widths, int slices, const std::string& key) {
    const auto count = static_cast<std::size_t>(slices);
    const std::vector<double> each =
        widths.each_mm.value_or(std::vector<double>(count, widths.all_mm.value_or(0.0)));
    if (each.size() != count)
      return wrong(key, ErrorKind::OutOfRange,
                   fmt::format("has {} widths for {} slices; give one for each slice or a single "
                               "number",
                               each.size(), slices));
    spec_.widths_mm.insert(spec_.widths_mm.end(), each.begin(), each.end());
    return true;
  }

  bool set_widths() {
    if (!spec_.region_fields.empty()) return true;
    if (!fields_.has("widths_mm"))
      return wrong("widths_mm", ErrorKind::Malformed,
                   "is missing; must be a number or a list of numbers");
    spec_.adaptive = spec_.widths.adaptive;
    return spec_.adaptive || add_widths(spec_.widths, *spec_.slices, "widths_mm");
  }

  bool check_units() {
    std::int64_t units = 0;
    for (const RegionSpec& region : spec_.regions)
      units += static_cast<std::int64_t>(region.units_per_slice) * region.slices;
    if (units <= kMaxUnits) return true;
    return wrong(!spec_.region_fields.empty() ? "regions" : "slices", ErrorKind::OutOfRange,
                 fmt::format("makes {} units in all; must make at most {}", units, kMaxUnits));
  }

  bool set_surface() {
    if (spec_.composite_radii) return set_composite(*spec_.composite_radii);
    if (!spec_.surface) return check_radii();
    const auto has_radius = [](const RegionSpec& region) { return region.radius.has_value(); };
    if (!std::all_of(spec_.regions.begin(), spec_.regions.end(), has_radius)) return true;
    return wrong("surface", ErrorKind::Malformed,
                 fmt::format("contradicts {}, which all have a radius; leave one of them out",
                             fields_.pointer("regions")));
  }

  /// What stands on two pages of its own, which open flat.
  bool check_standing(const char* style) {
    for (const char* one :
         {"book", "design_angle_deg", "card", "min_panel_mm", "translate_mm", "sheet"})
      if (fields_.has(one))
        return wrong(one, ErrorKind::Malformed,
                     fmt::format("contradicts {}, which is \"{}\": they stand in the middle of "
                                 "two pages that open flat; leave it out",
                                 fields_.pointer("style"), style));
    if (!spec_.surface)
      return wrong("surface", ErrorKind::Malformed,
                   "is missing; give a surface such as {\"type\": \"mesh\", \"file\": ...}");
    spec_.fit = FitMode::Nearest;
    return true;
  }

  /// Slices and boxes are made of what has sides all around.
  bool check_solid(const char* why) {
    if (!check_standing(parts_word(spec_.style))) return false;
    const char* const word = solid_word(*spec_.surface);
    if (word != nullptr && std::string_view(word) != "grid") return true;
    return wrong("surface/type", ErrorKind::Malformed,
                 fmt::format("must be mesh, text or drawing; {}", why));
  }

  /// Layers stand on pages of their own, as the model's depth wants.
  bool check_layers() {
    if (!check_standing("layers")) return false;
    if (const double opens = spec_.layers.opens_deg; opens != 90.0 && opens != 180.0)
      return wrong(
          "layers/opens_deg", ErrorKind::OutOfRange,
          fmt::format("is {:g}; layers stand on a card that opens to 90 or to 180 degrees", opens));
    spec_.facets.from_mm = spec_.given_from_mm.value_or(0.0);
    if (const char* const solid = solid_word(*spec_.surface))
      for (const auto& [is_given, field] :
           {std::pair(spec_.given_from_mm.has_value(), "layers/from_mm"),
            std::pair(spec_.facets.length_mm.has_value(), "layers/length_mm")})
        if (is_given)
          return wrong(
              field, ErrorKind::Malformed,
              fmt::format("is for a formula; a {} has its own ends, so leave it out", solid));
    if (solid_word(*spec_.surface) || spec_.facets.length_mm) return true;
    return wrong(
        "layers/length_mm", ErrorKind::Malformed,
        fmt::format("is missing; must be a number above 0 and at most {:g}, since a formula "
                    "does not say where it ends",
                    kMaxLength));
  }

  bool check_facet_surface() {
    if (spec_.composite_radii)
      return wrong("surface/type", ErrorKind::OutOfRange,
                   "is composite, which has regions; facets have none, so give another surface");
    if (spec_.surface) return true;
    return wrong("surface", ErrorKind::Malformed,
                 "is missing; give a surface such as {\"type\": \"mesh\", \"file\": ...}");
  }

  bool set_facets() {
    spec_.facets.from_given = spec_.given_from_mm.has_value();
    spec_.facets.from_mm = spec_.given_from_mm.value_or(0.0);
    spec_.fit = FitMode::Nearest;
    if (!spec_.card)
      return wrong("card", ErrorKind::Malformed,
                   "is false; facets hang on wall and ground, so leave it out");
    if (spec_.book && spec_.facets.sloped == SlopedParts::Tents)
      return wrong("facets/sloped", ErrorKind::OutOfRange,
                   "is tents, and cards of a book are of one sheet; choose kites or none");
    if (spec_.placement.design_angle_deg != 90.0)
      return wrong("design_angle_deg", ErrorKind::OutOfRange,
                   fmt::format("is {:g}; facets are made for 90 degrees only",
                               spec_.placement.design_angle_deg));
    if (!spec_.facets.length_mm && !solid_word(spec_.surface))
      return wrong(spec_.style == DesignStyle::Facets ? "facets/length_mm" : "silhouette/length_mm",
                   ErrorKind::Malformed,
                   fmt::format("is missing; must be a number above 0 and at most {:g}, since a "
                               "formula does not say where it ends",
                               kMaxLength));
    return true;
  }

  /// Without a surface each region needs a radius.
  bool check_radii() {
    for (std::size_t r = 0; r < spec_.regions.size(); ++r)
      if (!spec_.regions[r].radius)
        return wrong(
            spec_.region_fields.empty() ? "surface" : fmt::format("regions/{}/radius", r),
            ErrorKind::Malformed,
            "is missing; give a surface such as {\"type\": \"revolution\", \"radius\": ...}");
    return true;
  }

  /// The paper's composite (S2.F): three stretches whose radius runs R1 -> R2 -> R3 -> R2 by its
  /// three formulas, each over the length L of its own region.
  bool set_composite(const std::array<double, 3>& radii) {
    const auto [r1, r2, r3] = radii;
    if (!(r1 > r3 && r3 > r2))
      return wrong("surface/radii", ErrorKind::OutOfRange,
                   fmt::format("are {:g}, {:g}, {:g}; must be R1 > R3 > R2", r1, r2, r3));
    if (spec_.regions.size() != 3)
      return wrong(
          "regions", ErrorKind::OutOfRange,
          fmt::format("are {}; must be three for a composite surface", spec_.regions.size()));
    for (std::size_t r = 0; r < 3; ++r)
      if (spec_.regions[r].radius)
        return wrong(fmt::format("regions/{}/radius", r), ErrorKind::Malformed,
                     "contradicts the composite surface, which sets it");
    spec_.composite_radii = radii;
    spec_.regions[0].radius = fmt::format("{0} + ({1} - {0})*0.5*(1 + cos(pi*(y/L - 1)))", r1, r2);
    spec_.regions[1].radius =
        fmt::format("{0} + ({1} - {0})*0.5*(1 + sin(pi*(y/L - 0.5)))", r2, r3);
    spec_.regions[2].radius = fmt::format("{0} + ({1} - {0})*0.5*(1 - cos(pi*y/L))", r3, r2);
    return true;
  }

  bool check_placement() {
    for (const RegionSpec& region : spec_.regions)
      for (const char* moved : {"rotate_deg", "translate_mm"})
        if (region.radius && fields_.has(moved))
          return wrong(moved, ErrorKind::Malformed,
                       "contradicts the regions' radii, which stand about the spine; leave one of "
                       "them out");
    return true;
  }

  void set_min_panel() {
    spec_.min_panel_asked = spec_.given_min_panel_mm.has_value();
    spec_.min_panel_mm = spec_.given_min_panel_mm.value_or(spec_.min_panel_mm);
  }

  void set_splay() {
    if (!spec_.splay) return;
    spec_.splay->ligament_asked = spec_.given_ligament_mm.has_value();
    spec_.splay->ligament_mm = spec_.given_ligament_mm.value_or(std::max(1.0, spec_.min_panel_mm));
  }

  void set_lattice() {
    if (spec_.curvature && !fields_.has("lattice")) spec_.lattice = LatticeMethod::Slices;
    // V-folds need creases with room beside them, which the nearest lattice does not keep.
    else if (spec_.splay && !fields_.has("lattice"))
      spec_.lattice = LatticeMethod::Conformal;
    spec_.max_step_asked = fields_.has("max_step_over_mean");
  }

  FieldReader& fields_;
  SpecFields& spec_;
};

/// What contradicts a design's regions.
void check_regions(FieldReader& fields) {
  for (const char* single : kOneRegion)
    if (fields.has("regions") && fields.has(single))
      return fields.refuse(single, ErrorKind::Malformed,
                           fmt::format("contradicts {}, which have their own; give one or the "
                                       "other",
                                       fields.pointer("regions")));
}

/// Styles that have fields of their own, and the name of these.
struct OwnStyle {
  std::string_view name, field;
};
constexpr std::array kOwnStyles{OwnStyle{"facets", "facets"}, OwnStyle{"silhouette", "silhouette"},
                                OwnStyle{"layers", "layers"}, OwnStyle{"slices", "sliceform"},
                                OwnStyle{"boxes", "boxes"}};

/// The style where it is one of `kOwnStyles`, else "".
std::string_view own_style(FieldReader& fields) {
  const json* const style = fields.value("style");
  for (const OwnStyle& own : kOwnStyles)
    if (style != nullptr && style->is_string() && style->get_ref<const std::string&>() == own.name)
      return own.name;
  return "";
}

constexpr std::array kOfLattices{
    "units_per_slice", "slices", "widths_mm", "regions",   "lattice",
    "solver",          "fit",    "splay",     "curvature", "max_step_over_mean"};

/// What only one of the styles has.
void check_style(FieldReader& fields) {
  const std::string_view style = own_style(fields);
  for (const OwnStyle& other : kOwnStyles)
    if (other.name != style && fields.has(std::string(other.field)))
      return fields.refuse(std::string(other.field), ErrorKind::Malformed,
                           fmt::format("is for another style; give \"style\": \"{}\" too, or "
                                       "leave it out",
                                       other.name));
  if (style.empty()) return;
  for (const char* one : kOfLattices)
    if (fields.has(one))
      return fields.refuse(one, ErrorKind::Malformed,
                           fmt::format("contradicts {}, which is \"{}\"; leave it out",
                                       fields.pointer("style"), style));
}

/// What a design without regions needs.
void need_one_region(FieldReader& fields) {
  if (fields.has("regions")) return;
  fields.need("units_per_slice",
              fmt::format("must be a whole number from 1 to {}", kMaxUnitsPerSlice));
  fields.need("slices", fmt::format("must be a whole number from 1 to {}", kMaxSlices));
}

/// Curvature is that of the surface at a right angle. @return whether none contradicts the angle
bool check_curvature(FieldReader& fields, const std::string& key, const DesignSpec& spec) {
  if (!spec.curvature || spec.placement.design_angle_deg == 90.0) return true;
  fields.refuse(key, ErrorKind::OutOfRange,
                fmt::format("holds at a right angle only, but design_angle_deg is {:g}; leave one "
                            "of them out",
                            spec.placement.design_angle_deg));
  return false;
}

/// Reads the rows of one design and applies its rules. @return whether it has no fault
bool read_design(FieldReader& fields, std::initializer_list<const FieldTable*> tables,
                 SpecFields& spec) {
  const std::size_t before = fields.faults().size();
  check_regions(fields);
  check_style(fields);
  for (const FieldTable* table : tables) read_fields(*table, fields);
  if (own_style(fields).empty()) need_one_region(fields);
  static_cast<void>(fields.finish());
  return fields.faults().size() == before && Design(fields, spec).complete() &&
         check_curvature(fields, "curvature", spec);
}

// ---- patches

void set_joins(FieldReader& fields, SpecFields& whole) {
  const std::size_t borders = whole.patch_fields.size() - 1;
  if (whole.joins.empty()) whole.joins.assign(borders, whole.join_of_all.value_or(PatchJoin::Auto));
  if (whole.joins.size() != borders)
    fields.refuse("join", ErrorKind::OutOfRange,
                  fmt::format("has {} words for {} borders; give one for each border or a single "
                              "word",
                              whole.joins.size(), borders));
}

/// A patch with what the whole has for those that have none of their own.
json completed(const json& patch, const json& whole, const FieldTable& shared) {
  json out = patch;
  for (const Field& row : shared.rows) {
    const std::string name(row.name);
    if (!patch.contains(name) && whole.contains(name)) out[name] = whole[name];
  }
  return out;
}

/// What belongs beside the patches. @return whether the patch has none of it
bool check_patch(FieldReader& fields, std::size_t k, const json& patch, const SpecTables& tables) {
  for (const FieldTable* table : {&tables.whole, &tables.patches})
    for (const Field& row : table->rows)
      if (patch.contains(std::string(row.name))) {
        fields.refuse(fmt::format("patches/{}/{}", k, row.name), ErrorKind::Malformed,
                      "belongs to the whole, beside /patches; leave it out here");
        return false;
      }
  return true;
}

bool read_patch(FieldReader& fields, std::size_t k, const json& root, SpecFields& whole) {
  const std::string below = fmt::format("patches/{}", k);
  const json& given = whole.patch_fields[k];
  if (!given.is_object()) {
    static_cast<void>(fields.nested(given, below));
    return false;
  }
  SpecFields spec;
  const SpecTables tables = spec_tables(spec);
  if (!check_patch(fields, k, given, tables)) return false;
  const json patch = completed(given, root, tables.shared);
  FieldReader inner = fields.nested(patch, below);
  if (!read_design(inner, {&tables.name, &tables.shared, &tables.design}, spec)) return false;
  if (is_of_parts(spec.style)) {
    fields.refuse(below + "/style", ErrorKind::OutOfRange,
                  fmt::format("is {}, which are a card of their own; design them by themselves",
                              parts_word(spec.style)));
    return false;
  }
  if (is_of_facets(spec.style)) {
    fields.refuse(below + "/style", ErrorKind::OutOfRange,
                  "is facets, which are a sheet of their own; design them by themselves");
    return false;
  }
  if (!spec.card) {
    fields.refuse(given.contains("card") ? below + "/card" : "card", ErrorKind::Malformed,
                  "is false; each patch needs its card, since patches are joined at wall and "
                  "ground");
    return false;
  }
  if (!given.contains("name")) spec.name = fmt::format("patch {}", k + 1);
  spec.is_patch = true;
  spec.placement.design_angle_deg = whole.placement.design_angle_deg;
  if (!check_curvature(fields, below + "/curvature", spec)) return false;
  whole.patches.push_back(std::move(spec));
  return true;
}

void check_size(FieldReader& fields, const DesignSpec& whole) {
  std::int64_t slices = 0, units = 0;
  for (const DesignSpec& patch : whole.patches)
    for (const RegionSpec& region : patch.regions)
      slices += region.slices,
          units += static_cast<std::int64_t>(region.units_per_slice) * region.slices;
  if (slices > kMaxSlices || units > kMaxUnits)
    fields.refuse("patches", ErrorKind::OutOfRange,
                  fmt::format("have {} slices and {} units in all; must have at most {} and {}",
                              slices, units, kMaxSlices, kMaxUnits));
}

/// Reads a spec with "patches": a list of designs without "popcut", "material" and "patches".
void read_patches(FieldReader& fields, const json& root, SpecFields& whole) {
  const SpecTables tables = spec_tables(whole);
  if (fields.has("book"))
    return fields.refuse("book", ErrorKind::Malformed,
                         "contradicts /patches; a book is made of one design, so leave one of them "
                         "out");
  for (const FieldTable* table : {&tables.whole, &tables.name, &tables.patches})
    read_fields(*table, fields);
  for (const Field& row : tables.shared.rows)
    fields.value(std::string(row.name));  // read with the patches
  for (const Field& row : tables.design.rows)
    if (const std::string name(row.name); fields.value(name) != nullptr)
      return fields.refuse(name, ErrorKind::Malformed,
                           "contradicts /patches, which have their own; give one or the other");
  if (!fields.finish()) return;
  set_joins(fields, whole);
  for (std::size_t k = 0; k < whole.patch_fields.size() && fields.faults().empty(); ++k)
    if (!read_patch(fields, k, root, whole)) return;
  check_size(fields, whole);
}

// ---- the schema

/// The forms of a spec, each with what it needs and what cannot stand beside it: a lattice of one
/// region, one of several regions, patches, facets, a silhouette, layers, slices, boxes. A book
/// goes with lattices or has four cards.
constexpr std::string_view kForms = R"({
  "one": {"required": ["surface", "units_per_slice", "slices", "widths_mm"],
          "properties": {"style": {"const": "lattice"}, "facets": false, "silhouette": false,
                         "layers": false, "sliceform": false, "boxes": false, "regions": false},
          "additionalProperties": true},
  "several": {"required": ["regions"],
              "properties": {"style": {"const": "lattice"}, "facets": false,
                             "silhouette": false, "layers": false, "sliceform": false,
                             "boxes": false},
              "additionalProperties": true},
  "patches": {"required": ["patches"], "properties": {"book": false},
              "additionalProperties": true},
  "facets": {"required": ["style", "surface"],
             "properties": {"style": {"const": "facets"}, "silhouette": false,
                            "layers": false, "sliceform": false, "boxes": false},
             "additionalProperties": true},
  "silhouette": {"required": ["style", "surface"],
                 "properties": {"style": {"const": "silhouette"}, "facets": false,
                                "layers": false, "sliceform": false, "boxes": false},
                 "additionalProperties": true},
  "layers": {"required": ["style", "surface"],
             "properties": {"style": {"const": "layers"}, "facets": false, "silhouette": false,
                            "sliceform": false, "boxes": false,
                            "book": false, "design_angle_deg": false, "card": false,
                            "min_panel_mm": false, "translate_mm": false, "sheet": false},
             "additionalProperties": true},
  "slices": {"required": ["style", "surface"],
             "properties": {"style": {"const": "slices"}, "facets": false, "silhouette": false,
                            "layers": false, "boxes": false,
                            "book": false, "design_angle_deg": false, "card": false,
                            "min_panel_mm": false, "translate_mm": false, "sheet": false},
             "additionalProperties": true},
  "boxes": {"required": ["style", "surface"],
            "properties": {"style": {"const": "boxes"}, "facets": false, "silhouette": false,
                           "layers": false, "sliceform": false,
                           "book": false, "design_angle_deg": false, "card": false,
                           "min_panel_mm": false, "translate_mm": false, "sheet": false},
            "additionalProperties": true},
  "books": [
    {"properties": {"book": false}, "additionalProperties": true},
    {"properties": {
       "design_angle_deg": false,
       "curvature": false,
       "widths_mm": {"description": "in a book: the same on all cards",
                     "type": ["number", "array"]},
       "card": {"description": "in a book: its pages", "type": "object",
                "properties": {"shut": {"const": "inside"}}, "additionalProperties": true}},
     "anyOf": [
       {"properties": {"style": {"const": "lattice"}}, "additionalProperties": true},
       {"properties": {"book": {"description": "of facets: four cards",
                                "properties": {"cards": {"const": 4}},
                                "additionalProperties": true}},
        "additionalProperties": true}],
     "additionalProperties": true}],
  "patch": {"type": "object", "properties": {}, "additionalProperties": false},
  "spec": {"$schema": "https://json-schema.org/draft/2020-12/schema",
           "title": "popcut design spec", "type": "object", "additionalProperties": false}
})";

/// Forbids a form the fields of a part of the table.
void forbid(json& form, const FieldTable& table) {
  for (const Field& row : table.rows) form["properties"][std::string(row.name)] = false;
}

void forbid(json& form, std::span<const char* const> names) {
  for (const char* name : names) form["properties"][name] = false;
}

}  // namespace

Result<DesignSpec> parse_design_spec(std::string_view json_text) {
  constexpr std::size_t kMostBytes = 4u << 20;
  if (json_text.size() > kMostBytes)
    return fail(
        ErrorKind::OutOfRange, "",
        fmt::format("the spec has {} bytes; must have at most {}", json_text.size(), kMostBytes));
  const auto root = parse_json(json_text);
  if (!root) return tl::unexpected(root.error());
  FieldReader fields(*root);
  SpecFields spec;
  const SpecTables tables = spec_tables(spec);
  if (root->is_object() && root->contains("patches"))
    read_patches(fields, *root, spec);
  else if (root->is_object())
    read_design(fields, {&tables.whole, &tables.name, &tables.shared, &tables.design}, spec);
  if (const auto done = fields.finish(); !done) return tl::unexpected(done.error());
  return DesignSpec(std::move(spec));
}

std::string design_spec_schema() {
  SpecFields usual;
  const SpecTables tables = spec_tables(usual);
  json forms = *parse_json(kForms);
  json &one = forms["one"], &several = forms["several"], &patches = forms["patches"],
       &facets = forms["facets"], &silhouette = forms["silhouette"], &layers = forms["layers"],
       &slices = forms["slices"], &boxes = forms["boxes"], &patch = forms["patch"],
       &schema = forms["spec"];
  forbid(several, kOneRegion);
  for (json* form : {&facets, &silhouette, &layers, &slices, &boxes}) forbid(*form, kOfLattices);
  patch["oneOf"] = {one, several};
  for (const FieldTable* table : {&tables.name, &tables.shared, &tables.design})
    for (const Field& row : table->rows)
      patch["properties"][std::string(row.name)]["$ref"] = fmt::format("#/properties/{}", row.name);
  for (json* form : {&one, &several, &facets, &silhouette, &layers, &slices, &boxes})
    forbid(*form, tables.patches);
  forbid(patches, tables.design);
  for (const FieldTable* table :
       {&tables.whole, &tables.name, &tables.shared, &tables.design, &tables.patches})
    describe_fields(*table, schema);
  schema["required"] = {"popcut"};
  schema["properties"]["patches"]["items"] = patch;
  schema["oneOf"] = {one, several, patches, facets, silhouette, layers, slices, boxes};
  schema["anyOf"] = forms["books"];
  return json_file(schema);
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include "core/design/spec/patches_spec.hpp"

#include <fmt/format.h>

#include "core/text/field_reader.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr std::size_t kMostPatches = 100;
constexpr double kMostTolerance = 1e5;
const std::vector<std::string> kJoinWords{"auto", "sheet", "seam"};
constexpr const char* kShared[] = {"card",   "fit",          "lattice",
                                   "solver", "min_panel_mm", "max_step_over_mean"};

Result<std::vector<PatchJoin>> parse_joins(const json* value, std::size_t borders) {
  const auto word = [](const json& text, const std::string& place) -> Result<PatchJoin> {
    for (std::size_t k = 0; k < kJoinWords.size(); ++k)
      if (text == kJoinWords[k]) return static_cast<PatchJoin>(k);
    return fail(
        ErrorKind::Malformed, place,
        fmt::format("is {}; \"auto\", \"sheet\" or \"seam\" is needed",
                    text.is_string() ? text.dump(-1, ' ', false, json::error_handler_t::replace)
                                     : json_type(text)));
  };
  if (!value || !value->is_array()) {
    const auto all = value ? word(*value, "/join") : PatchJoin::Auto;
    if (!all) return tl::unexpected(all.error());
    return std::vector<PatchJoin>(borders, *all);
  }
  if (value->size() != borders)
    return fail(ErrorKind::OutOfRange, "/join",
                fmt::format("has {} words for {} borders; one a border or a single word is needed",
                            value->size(), borders));
  std::vector<PatchJoin> joins;
  for (std::size_t k = 0; k < borders; ++k) {
    const auto one = word((*value)[k], fmt::format("/join/{}", k));
    if (!one) return tl::unexpected(one.error());
    joins.push_back(*one);
  }
  return joins;
}

/// A patch's own fields, with those of the whole that it has not.
Result<json> complete(const json& patch, const json& root, const std::string& place) {
  if (!patch.is_object())
    return fail(ErrorKind::Malformed, place,
                fmt::format("is {}; a design is needed, an object", json_type(patch)));
  for (const char* of_whole : {"popcut", "material", "patches", "join", "join_tolerance_mm"})
    if (patch.contains(of_whole))
      return fail(ErrorKind::Malformed, fmt::format("{}/{}", place, of_whole),
                  "belongs to the whole, beside /patches; leave it out here");
  json out = patch;
  out["popcut"] = 1;
  for (const char* field : kShared)
    if (!patch.contains(field) && root.contains(field)) out[field] = root[field];
  return out;
}

Result<void> check_size(const DesignSpec& whole) {
  long slices = 0, units = 0;
  for (const DesignSpec& patch : whole.patches)
    for (const RegionSpec& region : patch.regions)
      slices += region.slices, units += static_cast<long>(region.units_per_slice) * region.slices;
  if (slices <= kMaxSlices && units <= kMaxUnits) return {};
  return fail(ErrorKind::OutOfRange, "/patches",
              fmt::format("have {} slices and {} units in all; at most {} and {} are designed",
                          slices, units, kMaxSlices, kMaxUnits));
}

}  // namespace

Result<DesignSpec> parse_patches(const json& root, ParseDesign parse_one) {
  FieldReader fields(root, "");
  DesignSpec whole;
  (void)fields.integer("popcut", std::nullopt, 1, 1);
  whole.name = fields.text("name", whole.name);
  whole.material = fields.text("material", whole.material);
  const json* patches = fields.value("patches");
  const json* join = fields.value("join");
  whole.join_tolerance_mm =
      fields.number("join_tolerance_mm", whole.join_tolerance_mm, 0.0, kMostTolerance);
  for (const char* field : kShared) (void)fields.value(field);
  for (const char* own : {"surface", "units_per_slice", "slices", "widths_mm", "regions", "splay",
                          "scale_mm", "rotate_deg", "translate_mm"})
    if (fields.has(own))
      return fail(ErrorKind::Malformed, fields.pointer(own),
                  "contradicts /patches, which have their own; give one or the other");
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  if (!patches->is_array() || patches->size() < 2 || patches->size() > kMostPatches)
    return fail(ErrorKind::Malformed, "/patches",
                fmt::format("must be a list of 2 to {} designs", kMostPatches));
  auto joins = parse_joins(join, patches->size() - 1);
  if (!joins) return tl::unexpected(joins.error());
  whole.joins = std::move(*joins);
  for (std::size_t k = 0; k < patches->size(); ++k) {
    const std::string place = fmt::format("/patches/{}", k);
    const auto text = complete((*patches)[k], root, place);
    if (!text) return tl::unexpected(text.error());
    auto patch = parse_one(*text);
    if (!patch) {
      Error error = patch.error();
      error.place = place + error.place;
      return tl::unexpected(std::move(error));
    }
    if (!patch->card)
      return fail(ErrorKind::Malformed, (*patches)[k].contains("card") ? place + "/card" : "/card",
                  "is false; patches are joined at wall and ground, so each needs its card");
    if (!(*patches)[k].contains("name")) patch->name = fmt::format("patch {}", k + 1);
    patch->is_patch = true;
    whole.patches.push_back(std::move(*patch));
  }
  if (auto lawful = check_size(whole); !lawful) return tl::unexpected(lawful.error());
  return whole;
}

void add_patches_schema(json& properties) {
  properties["patches"] = {
      {"type", "array"},
      {"description",
       "designs that are joined one after another along the spine, each with the fields of a "
       "design but popcut and material; then only name, material, join, join_tolerance_mm and "
       "defaults for card, fit, lattice, solver, min_panel_mm and max_step_over_mean stand beside "
       "it"},
      {"minItems", 2},
      {"maxItems", kMostPatches},
      {"items", {{"type", "object"}}}};
  const json words{{"enum", kJoinWords}};
  properties["join"] = {
      {"description",
       "auto: one sheet where walls and grounds agree, else a seam; sheet: one sheet or an error; "
       "seam: patterns of their own that are glued; one word for all borders, or a list"},
      {"default", "auto"},
      {"oneOf", json::array({words, {{"type", "array"}, {"items", words}}})}};
  properties["join_tolerance_mm"] = {
      {"type", "number"},
      {"minimum", 0},
      {"maximum", kMostTolerance},
      {"default", 1},
      {"description", "largest distance between the profiles of two edges that are joined"}};
}

}  // namespace popcut

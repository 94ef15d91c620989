// SPDX-License-Identifier: MIT
#include "daemon/cli/input/compared_parts.hpp"

#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/judge/boxes_likeness.hpp"
#include "core/judge/layers_likeness.hpp"
#include "core/text/file_kind.hpp"
#include "core/text/fold_text.hpp"
#include "core/text/json_text.hpp"
#include "daemon/cli/input/model_file.hpp"
#include "daemon/cli/input/spec_assets.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/views/parts_card.hpp"

namespace popcut::cli {
namespace compared_parts {
namespace {

constexpr std::uintmax_t kMostPartsBytes = 1u << 26;

/// A FOLD file without what differs from one version of popcut to the next.
Result<nlohmann::json> card_json(const std::string& file, const std::string& text) {
  auto json = parse_json(text);
  if (!json) return tl::unexpected(within(file, json.error()));
  if (json->is_object()) json->erase("file_creator");
  return json;
}

}  // namespace
}  // namespace compared_parts

bool is_card_of_parts(const std::string& file) {
  if (is_model_file(file)) return false;
  const auto text = read_file(file, compared_parts::kMostPartsBytes);
  return text && lists_joints(*text);
}

Result<ComparedParts> compare_parts(const std::string& pattern, const std::string& design,
                                    int pixels, const Progress& progress) {
  using namespace compared_parts;
  const auto card = read_file(pattern, kMostPartsBytes);
  if (!card) return tl::unexpected(card.error());
  const auto text = is_model_file(design) ? Result<std::string>(std::string())
                                          : read_file(design, kMostPartsBytes);
  if (!text) return tl::unexpected(text.error());
  if (!is_design_spec(*text))
    return fail(ErrorKind::OutOfRange, design,
                "is no design; a card of several parts is compared with its own design, so give "
                "the .json that it was designed from");
  auto spec = parse_design_spec(*text);
  if (!spec) return tl::unexpected(within(design, spec.error()));
  if (spec->style != DesignStyle::Layers && !is_of_boxes(*spec))
    return fail(ErrorKind::OutOfRange, design + ": /style",
                "must be layers or boxes, or facets with \"sloped\": \"tents\", to be compared "
                "printed with a card of several parts");
  const auto material = material_of(*spec, design);
  if (!material) return tl::unexpected(material.error());
  planning::suit_material(*material, *spec);
  const auto assets = load_assets(*spec, design);
  if (!assets) return tl::unexpected(within(design, assets.error()));
  const auto made = planning::parts_card(*spec, *assets, false, progress);
  if (!made) return tl::unexpected(within(design, made.error()));
  const auto given = card_json(pattern, *card);
  if (!given) return tl::unexpected(given.error());
  if (*given != card_json(design, made->fold).value())
    return fail(ErrorKind::OutOfRange, pattern,
                fmt::format("is not the card that this popcut makes from {}; give its own design, "
                            "or design it again",
                            design));
  tell(progress, "comparing", kUnknownPart);
  if (made->layers)
    return ComparedParts{
        judge::layers_likeness(*made->layers,
                               asset_colours(design, *assets, made->layers->target.size()), pixels),
        made->layers->opens_flat};
  return ComparedParts{
      judge::boxes_likeness(*made->boxes,
                            asset_colours(design, *assets, made->boxes->target.size()), pixels),
      !made->boxes->is_of_facets()};
}

}  // namespace popcut::cli

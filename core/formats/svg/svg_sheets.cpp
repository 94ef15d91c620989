// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_sheets.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace popcut {

Result<void> read_svg_sheets(const SvgText& text, const pugi::xml_node& root, CssSheets& sheets,
                             SvgNotes& notes) {
  Result<void> all;
  each_svg_element(root, [&](const pugi::xml_node& node) {
    std::string_view name = node.name();
    name.remove_prefix(std::min(name.rfind(':') + 1, name.size()));
    if (name != "style" || !all) return;
    const std::string_view type = node.attribute("type").value();
    const std::string_view media = node.attribute("media").value();
    if ((!type.empty() && type != "text/css") || media == "print") return;
    std::string sheet;
    for (const pugi::xml_node& part : node.children()) sheet += part.value();
    if (auto done = sheets.add(sheet); !done)
      all = fail(done.error().kind, svg_place(text, node.offset_debug() - 1), done.error().detail,
                 done.error().reason);
  });
  const auto first = [&] { return fmt::format("\"{}\"", sheets.first_unknown()); };
  const auto none = [] { return std::string(); };
  if (sheets.unknown_selectors() > 0)
    notes.add(SvgNote::Selector, first, sheets.unknown_selectors());
  if (sheets.unknown_blocks() > 0) notes.add(SvgNote::SheetBlock, first, sheets.unknown_blocks());
  if (sheets.imports() > 0) notes.add(SvgNote::ForeignSheet, none, sheets.imports());
  return all;
}

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include <cstdint>
#include <string>
#include <string_view>

#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/formats/svg/syntax/svg_css.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

// The text is a style sheet, and each of its declarations a colour, a length and dashes too.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const pugi::xml_document document = [] {
    pugi::xml_document made;
    made.load_string(
        "<svg><g class='a b' id='i'><path class='cut a' id='p' data-x='yes no'/></g></svg>");
    return made;
  }();
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  popcut::CssSheets sheets;
  const auto added = sheets.add(text);
  const pugi::xml_node path = document.child("svg").child("g").child("path");
  std::size_t steps = 100'000;
  std::vector<const popcut::CssRule*> found;
  const bool done = sheets.find(path, "path", "p", "cut a", steps, found);
  (void)added, (void)done;
  for (const popcut::CssRule* rule : found) {
    std::string_view rest = rule->declarations;
    popcut::CssDeclaration one;
    while (popcut::next_declaration(rest, one)) {
      (void)popcut::parse_svg_paint(one.value);
      (void)popcut::parse_svg_length(one.value);
      (void)popcut::parse_svg_dashes(one.value);
    }
  }
  return 0;
}

// SPDX-License-Identifier: MIT
#pragma once

#include <pugixml.hpp>

#include "core/formats/svg/syntax/svg_css.hpp"
#include "core/formats/svg/syntax/svg_notes.hpp"
#include "core/formats/svg/syntax/svg_text.hpp"
#include "core/result.hpp"

namespace popcut {

/// Visits `root` and all elements below it in document order, without recursion.
template <typename Visit>
void each_svg_element(const pugi::xml_node& root, Visit visit) {
  pugi::xml_node node = root;
  while (node) {
    if (node.type() == pugi::node_element) visit(node);
    if (node.first_child()) {
      node = node.first_child();
      continue;
    }
    while (node != root && !node.next_sibling()) node = node.parent();
    if (node == root) return;
    node = node.next_sibling();
  }
}

/// Reads all <style> elements of a document; adds a note for what it does not understand.
///
/// @retval OutOfRange  too many selectors; place is that of the <style> element
[[nodiscard]] Result<void> read_svg_sheets(const SvgText& text, const pugi::xml_node& root,
                                           CssSheets& sheets, SvgNotes& notes);

}  // namespace popcut

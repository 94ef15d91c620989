// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <pugixml.hpp>

#include "core/result.hpp"

namespace popcut {

/// One declaration of a style sheet or of a `style` attribute.
struct CssDeclaration {
  std::string_view name, value;
  bool important{false};
};

/// Takes the first declaration off `rest`, quotes and brackets respected; false at the end. What
/// is no declaration is passed over.
[[nodiscard]] bool next_declaration(std::string_view& rest, CssDeclaration& out);
/// The text with blanks for its comments.
[[nodiscard]] std::string without_css_comments(std::string_view text);

/// `name`, `name=value` and the like between brackets of a selector.
struct CssAttribute {
  std::string_view name, value;
  char test{};  ///< 0 (is there), '=', or the character before '=': ~ | ^ $ *
};

/// What one element must be: `path.cut#a[data-x]`.
struct CssCompound {
  std::string_view type, id;  ///< empty: any
  std::vector<std::string_view> classes;
  std::vector<CssAttribute> attributes;
  bool is_root{false};
  bool child{false};  ///< it is the parent of the next one, not only an ancestor
};

/// One selector with its declarations.
struct CssRule {
  std::vector<CssCompound> parts;  ///< outermost first; the last is the element itself
  std::uint32_t specificity{};
  std::string_view declarations;
};

/// The style sheets of a document: selectors by type, class, id, attribute, descendant and child.
class CssSheets {
 public:
  static constexpr std::size_t kMostSelectors = 50'000;

  /// Reads one sheet. What it does not know is passed over and counted.
  ///
  /// @retval OutOfRange  more than `kMostSelectors` in all sheets
  [[nodiscard]] Result<void> add(std::string_view text);

  /// Adds the rules that fit `node` to `found`, weakest first. Comparisons are taken off `steps`;
  /// false when they do not suffice.
  [[nodiscard]] bool find(const pugi::xml_node& node, std::string_view type, std::string_view id,
                          std::string_view classes, std::size_t& steps,
                          std::vector<const CssRule*>& found) const;

  [[nodiscard]] bool empty() const { return rules_.empty(); }
  [[nodiscard]] std::size_t unknown_selectors() const { return unknown_selectors_; }
  [[nodiscard]] std::size_t unknown_blocks() const { return unknown_blocks_; }  ///< @media ...
  [[nodiscard]] std::size_t imports() const { return imports_; }
  /// The first selector or block that is not known.
  [[nodiscard]] const std::string& first_unknown() const { return first_unknown_; }

 private:
  friend class CssSheetReader;
  using Bucket = std::vector<std::uint32_t>;
  std::deque<std::string> texts_;  ///< what all views point into
  std::vector<CssRule> rules_;
  std::unordered_map<std::string_view, Bucket> by_id_, by_class_, by_type_;
  Bucket others_;
  std::size_t unknown_selectors_{}, unknown_blocks_{}, imports_{};
  std::string first_unknown_;
};

}  // namespace popcut

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

/// Removes the first declaration from `rest`, respecting quotes and brackets; returns false at the
/// end. Skips what is not a declaration.
[[nodiscard]] bool next_declaration(std::string_view& rest, CssDeclaration& out);
/// The text with spaces in place of its comments.
[[nodiscard]] std::string without_css_comments(std::string_view text);

/// An attribute condition in brackets, such as `name` or `name=value`.
struct CssAttribute {
  std::string_view name, value;
  char test{};  ///< 0: it exists; '='; or the character before '=': ~ | ^ $ *
};

/// Conditions on one element: `path.cut#a[data-x]`.
struct CssCompound {
  std::string_view type, id;  ///< empty: any
  std::vector<std::string_view> classes;
  std::vector<CssAttribute> attributes;
  bool is_root{false};
  bool child{false};  ///< must be the parent of the next part, not just an ancestor
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

  /// Reads one sheet. Skips and counts what it does not know.
  ///
  /// @retval OutOfRange  more than `kMostSelectors` in all sheets
  [[nodiscard]] Result<void> add(std::string_view text);

  /// Appends the rules that match `node` to `found`, weakest first. Each comparison uses up one of
  /// `steps`; returns false if there are not enough.
  [[nodiscard]] bool find(const pugi::xml_node& node, std::string_view type, std::string_view id,
                          std::string_view classes, std::size_t& steps,
                          std::vector<const CssRule*>& found) const;

  [[nodiscard]] bool empty() const { return rules_.empty(); }
  [[nodiscard]] std::size_t unknown_selectors() const { return unknown_selectors_; }
  [[nodiscard]] std::size_t unknown_blocks() const { return unknown_blocks_; }  ///< @media ...
  [[nodiscard]] std::size_t imports() const { return imports_; }
  /// The first unknown selector or block.
  [[nodiscard]] const std::string& first_unknown() const { return first_unknown_; }

 private:
  friend class CssSheetReader;
  using Bucket = std::vector<std::uint32_t>;
  std::deque<std::string> texts_;  ///< storage behind all string views
  std::vector<CssRule> rules_;
  std::unordered_map<std::string_view, Bucket> by_id_, by_class_, by_type_;
  Bucket others_;
  std::size_t unknown_selectors_{}, unknown_blocks_{}, imports_{};
  std::string first_unknown_;
};

}  // namespace popcut

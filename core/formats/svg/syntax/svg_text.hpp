// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// Limits on a drawing. Each is checked before the memory or time is spent.
struct SvgLimits {
  std::size_t bytes{100'000'000};      ///< of the file, before and after replacing its entities
  std::size_t tree_bytes{400u << 20};  ///< memory of the document as a tree
  std::size_t points{4'000'000};       ///< of all lines
  std::size_t steps{
      200'000'000};  ///< characters, elements and comparisons, also in repeats by `use`
  int depth{200};    ///< nesting of groups and of `use`

  /// All limits times `factor`, except the depth; points stay below 2^31.
  [[nodiscard]] SvgLimits raised(unsigned factor) const;
};

/// The text of a drawing, ready for the XML parser.
struct SvgText {
  std::string text;                  ///< UTF-8; the DOCTYPE blanked, entities replaced
  std::vector<std::uint32_t> lines;  ///< where each line except the first begins
  bool has_foreign_sheet{false};     ///< an xml-stylesheet refers to another file
  bool by_illustrator{false};        ///< a comment before the root names Adobe Illustrator
};

/// Checks the size, unpacks gzip (.svgz), converts UTF-16 to UTF-8, and removes the DOCTYPE.
/// Replaces the entities of its internal subset: at most 64, of 256 bytes each, plain text. Never
/// fetches anything.
///
/// @retval Malformed   a broken gzip, binary, or declarations that are not plain entities
/// @retval OutOfRange  over a limit
[[nodiscard]] Result<SvgText> prepare_svg_text(std::string text, const SvgLimits& limits);

/// "line 3, column 7" of a byte offset.
[[nodiscard]] std::string svg_place(const SvgText& text, std::ptrdiff_t offset);
/// The line of a byte offset, from 1.
[[nodiscard]] std::size_t svg_line(const SvgText& text, std::ptrdiff_t offset);

}  // namespace popcut

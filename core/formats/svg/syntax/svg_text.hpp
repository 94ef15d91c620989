// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// What a drawing may take. All are checked before the memory or the time is taken.
struct SvgLimits {
  std::size_t bytes{100'000'000};      ///< of the file, and of it with its entities in place
  std::size_t tree_bytes{400u << 20};  ///< of the document as a tree
  std::size_t points{4'000'000};       ///< of all lines
  std::size_t steps{200'000'000};  ///< characters, elements and comparisons, repeats by `use` too
  int depth{200};                  ///< groups in groups, and `use` of `use`

  /// All but the depth times `factor`; points stay below 2^31.
  [[nodiscard]] SvgLimits raised(unsigned factor) const;
};

/// The text of a drawing, ready to become a tree.
struct SvgText {
  std::string text;                  ///< UTF-8; the DOCTYPE is blank, entities are in place
  std::vector<std::uint32_t> lines;  ///< where each line but the first begins
  bool has_foreign_sheet{false};     ///< an xml-stylesheet refers to another file
};

/// Checks the size, turns UTF-16 into UTF-8, and takes the DOCTYPE away. Nothing is ever fetched.
/// Entities of its internal subset are put in place: at most 64 of 256 bytes each, plain text.
///
/// @retval Malformed   compressed, binary, or declarations that are not plain entities
/// @retval OutOfRange  over a limit
[[nodiscard]] Result<SvgText> prepare_svg_text(std::string text, const SvgLimits& limits);

/// "line 3, column 7" of a byte.
[[nodiscard]] std::string svg_place(const SvgText& text, std::ptrdiff_t offset);
/// The line of a byte, from 1.
[[nodiscard]] std::size_t svg_line(const SvgText& text, std::ptrdiff_t offset);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut {

/// White space of SVG and CSS.
[[nodiscard]] inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

/// Reads SVG's little languages (path data, transforms, point lists) from left to right.
class SvgScan {
 public:
  explicit SvgScan(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end();
  /// The next character after blanks, 0 at the end; not taken.
  [[nodiscard]] char peek();
  void skip() { ++at_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  /// A finite number, with blanks and at most one comma before it.
  [[nodiscard]] bool number(double& out);
  /// A flag of an arc: 0 or 1, which need no separator.
  [[nodiscard]] bool flag(bool& out);
  /// Whether a number can begin here (after blanks and a comma).
  [[nodiscard]] bool number_follows();
  /// Letters up to the next that is none.
  [[nodiscard]] std::string_view word();

 private:
  void blanks();
  void separator();
  std::string_view text_;
  std::size_t at_{};
};

}  // namespace popcut

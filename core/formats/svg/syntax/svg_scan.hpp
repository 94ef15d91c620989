// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "core/text/words.hpp"

namespace popcut {

/// Reads SVG's small languages (path data, transforms, point lists) from left to right.
class SvgScan {
 public:
  explicit SvgScan(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end();
  /// The next character after spaces, without consuming it; 0 at the end.
  [[nodiscard]] char peek();
  void skip() { ++at_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  /// Reads a finite number after spaces and at most one comma.
  [[nodiscard]] bool number(double& out);
  /// Reads a flag of an arc: 0 or 1, which need no separator.
  [[nodiscard]] bool flag(bool& out);
  /// Whether a number can begin here (after spaces and a comma).
  [[nodiscard]] bool number_follows();
  /// Reads letters up to the next other character.
  [[nodiscard]] std::string_view word();

 private:
  void blanks();
  void separator();
  std::string_view text_;
  std::size_t at_{};
};

}  // namespace popcut

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace popcut {

/// Reads the numbers of one command character by character: decimal numbers with sign and fraction,
/// separated by commas, blanks or the next sign. No exponents: E is a command. Ignores the locale.
class Arguments {
 public:
  void clear();
  /// Takes a digit, point, sign, comma or blank. Returns false for any other character and ignores
  /// it.
  bool take(char c);
  /// The last number ends here.
  void end();
  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  /// True if something is not a number within +-2^31, or a number is missing between two commas.
  [[nodiscard]] bool bad() const { return bad_; }

 private:
  static constexpr std::size_t kLongestNumber = 32;
  std::array<char, kLongestNumber> text_{};
  std::size_t length_{};
  bool comma_{};
  bool bad_{};
  std::vector<double> values_;
};

}  // namespace popcut

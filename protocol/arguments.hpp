// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace popcut {

/// Reads the numbers of one command a character at a time: decimal numbers with sign and fraction,
/// parted by commas, blanks or the next sign. No exponents: E is a command. The locale is ignored.
class Arguments {
 public:
  void clear();
  /// Takes a digit, point, sign, comma or blank; false, and nothing taken, for other characters.
  bool take(char c);
  /// The last number ends here.
  void end();
  [[nodiscard]] const std::vector<double>& values() const { return values_; }
  /// Something could not be read as a number within +-2^31, or one is missing between two commas.
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

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>

namespace popcut {

inline constexpr std::size_t kLongestNumber = 32;  ///< characters

/// Appends `number` rounded to six decimals (nanometres, for mm), without trailing zeros.
void append_rounded(std::string& text, double number);

/// Text on its way to a stream: numbers are written by `std::to_chars`, in blocks, because large
/// patterns have millions of them. Flushes itself when it goes.
class TextSink {
 public:
  explicit TextSink(std::ostream& out) : out_(out) {}
  TextSink(const TextSink&) = delete;
  TextSink& operator=(const TextSink&) = delete;
  ~TextSink() { flush(); }

  void put(std::string_view text) {
    if (text.size() > block_.size() - used_) return put_past_block(text);
    text.copy(block_.data() + used_, text.size());
    used_ += text.size();
  }
  void put(std::integral auto number) { put_number(number); }
  /// The shortest digits that read back as the same double.
  void put(double number) { put_number(number); }
  /// `number` rounded to six decimals (nanometres, for mm), without trailing zeros.
  void put_rounded(double number);

  /// All parts in order.
  template <typename... Parts>
  void operator()(const Parts&... parts) {
    (put(parts), ...);
  }

  void flush() {
    out_.write(block_.data(), static_cast<std::streamsize>(used_));
    used_ = 0;
  }

 private:
  void put_past_block(std::string_view text);
  template <typename Number>
  void put_number(Number number) {
    if (block_.size() - used_ < kLongestNumber) flush();
    char* const first = block_.data() + used_;
    used_ +=
        static_cast<std::size_t>(std::to_chars(first, first + kLongestNumber, number).ptr - first);
  }

  std::ostream& out_;
  std::size_t used_{0};
  std::array<char, 1u << 16> block_;
};

/// `text` for an XML element or attribute: the five special characters escaped, control characters
/// (which XML 1.0 cannot hold) turned into blanks, U+FFFE, U+FFFF and what is not UTF-8 into
/// U+FFFD.
[[nodiscard]] std::string xml_escaped(std::string_view text);

/// `text` as a JSON string with its quotes; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string json_quoted(std::string_view text);

}  // namespace popcut

// SPDX-License-Identifier: MIT
#include "protocol/arguments.hpp"

#include <charconv>
#include <cmath>

namespace popcut {
void Arguments::clear() {
  length_ = 0;
  comma_ = bad_ = false;
  values_.clear();
}

bool Arguments::take(char c) {
  const bool sign = c == '-' || c == '+';
  if ((c >= '0' && c <= '9') || c == '.' || sign) {
    if (sign && length_ > 0) end();
    if (length_ < kLongestNumber)
      text_[length_++] = c;
    else
      bad_ = true;
    return true;
  }
  if (c == ',') {
    end();
    bad_ = bad_ || comma_;
    comma_ = true;
    return true;
  }
  if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
    end();
    return true;
  }
  return false;
}

void Arguments::end() {
  if (length_ == 0) return;
  const char* const begin = text_.data() + (text_[0] == '+' ? 1 : 0);
  const char* const end = text_.data() + length_;
  constexpr double kLargest = 2147483648.0;
  double value = 0;
  const auto [stop, code] = std::from_chars(begin, end, value, std::chars_format::fixed);
  if (code != std::errc() || stop != end || !(std::abs(value) <= kLargest))
    bad_ = true;
  else
    values_.push_back(value);
  length_ = 0;
  comma_ = false;
}

}  // namespace popcut

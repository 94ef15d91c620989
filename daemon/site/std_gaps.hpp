// SPDX-License-Identifier: MIT
// What the C++ library of Debian 12's emscripten (libc++ 13) lacks of C++20. Comes before each
// source.
#pragma once
#ifdef __cplusplus

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#if !defined(_LIBCPP_VERSION) || _LIBCPP_VERSION >= 14000
#error "this libc++ is not the one that these gaps were found in: try without std_gaps.hpp"
#endif

namespace std {

template <class To, class From>
To bit_cast(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  memcpy(&to, &from, sizeof(To));
  return to;
}

/// Only `general`, `fixed` and `scientific`, as fast_float knows them.
template <class Real, enable_if_t<is_floating_point_v<Real>, bool> = true>
from_chars_result from_chars(const char* first, const char* last, Real& value,
                             chars_format format = chars_format::general) {
  const auto as = format == chars_format::fixed        ? fast_float::chars_format::fixed
                  : format == chars_format::scientific ? fast_float::chars_format::scientific
                                                       : fast_float::chars_format::general;
  const auto read = fast_float::from_chars(first, last, value, as);
  return {read.ptr, read.ec};
}

/// The fewest digits that give the same number back; with an exponent only where that is shorter.
inline to_chars_result to_chars(char* first, char* last, double value) {
  char text[64];
  char* end = text;
  const auto add = [&](string_view part) { end = copy(part.begin(), part.end(), end); };
  const auto zeros = [&](int count) {
    for (; count > 0; --count) *end++ = '0';
  };
  if (signbit(value)) add("-");
  value = fabs(value);
  if (isnan(value)) {
    add("nan");
  } else if (isinf(value)) {
    add("inf");
  } else if (value == 0) {
    add("0");
  } else {
    const auto decimal = fmt::detail::dragonbox::to_decimal(value);
    char room[24];
    const string_view digits(
        room, static_cast<size_t>(fmt::format_to(room, "{}", decimal.significand) - room));
    const int count = static_cast<int>(digits.size()), point = count + decimal.exponent;
    const int exponent = point - 1;
    const int as_scientific = count + (count > 1) + 2 + (abs(exponent) > 99 ? 3 : 2);
    const int as_fixed = point <= 0 ? 2 - point + count : point >= count ? point : count + 1;
    if (as_fixed > as_scientific) {
      add(digits.substr(0, 1));
      if (count > 1) add("."), add(digits.substr(1));
      end = fmt::format_to(end, "e{}{:02}", exponent < 0 ? '-' : '+', abs(exponent));
    } else if (point <= 0) {
      add("0."), zeros(-point), add(digits);
    } else if (point >= count) {
      add(digits), zeros(point - count);
    } else {
      add(digits.substr(0, static_cast<size_t>(point))), add("."),
          add(digits.substr(static_cast<size_t>(point)));
    }
  }
  if (end - text > last - first) return {last, errc::value_too_large};
  return {copy(text, end, first), errc{}};
}

/// Ends with its thread. There is one thread, so nobody makes another one.
class jthread {
 public:
  template <class... Given>
  explicit jthread(Given&&... given) : thread_(forward<Given>(given)...) {}
  jthread(jthread&&) = default;
  ~jthread() {
    if (thread_.joinable()) thread_.join();
  }

 private:
  thread thread_;
};

}  // namespace std
#endif

// SPDX-License-Identifier: MIT
// The algorithms of std::ranges that popcut uses and libc++ 13 lacks, for whole containers. After
// std_gaps.hpp.
#pragma once
#ifdef __cplusplus

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace std::ranges {

template <class Range, class Less = std::less<>, class Of = std::identity>
void sort(Range&& range, Less less = {}, Of of = {}) {
  std::sort(std::begin(range), std::end(range), [&](const auto& a, const auto& b) {
    return std::invoke(less, std::invoke(of, a), std::invoke(of, b));
  });
}

template <class Range, class Test>
bool any_of(Range&& range, Test test) {
  return std::any_of(std::begin(range), std::end(range), std::move(test));
}

template <class Range, class Value>
auto find(Range&& range, const Value& value) {
  return std::find(std::begin(range), std::end(range), value);
}

template <class Range>
auto min(const Range& range) {
  return *std::min_element(std::begin(range), std::end(range));
}

}  // namespace std::ranges
#endif

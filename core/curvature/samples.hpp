// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace popcut {

/// `count` evenly spaced values from `from` to `to`, both ends with.
struct Samples {
  double from{};
  double to{};
  std::size_t count{};

  [[nodiscard]] double at(std::size_t k) const {
    if (k + 1 == count) return to;
    return from + (to - from) * (static_cast<double>(k) / static_cast<double>(count - 1));
  }
};

}  // namespace popcut

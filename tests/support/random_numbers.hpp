// SPDX-License-Identifier: MIT
#pragma once

#include <random>

namespace popcut::testing {

[[nodiscard]] inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A whole number from `low` to `high`, both included.
[[nodiscard]] inline int whole(std::mt19937& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

}  // namespace popcut::testing

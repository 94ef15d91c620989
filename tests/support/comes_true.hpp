// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <thread>

namespace popcut::testing {

/// Waits until `holds()` is true, asking every `step`; false if it is not within `seconds`.
template <typename Condition>
[[nodiscard]] bool comes_true(Condition holds, double seconds = 60,
                              std::chrono::milliseconds step = std::chrono::milliseconds(2)) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(step);
  }
  return true;
}

}  // namespace popcut::testing

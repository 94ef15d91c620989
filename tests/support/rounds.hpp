// SPDX-License-Identifier: MIT
// How often a test with random or listed inputs goes round.
#pragma once

#include <cstdlib>
#include <string_view>

namespace popcut::testing {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kWithSanitizer = true;
#else
constexpr bool kWithSanitizer = false;
#endif

/// True if a test is to take a part of its rounds. POPCUT_ROUNDS says so: "few" in './run test',
/// "all" in './run test --all' and './run soak sanitizers'. A program that is run by hand takes
/// all, but with a sanitizer, where each round takes several times as long.
[[nodiscard]] inline bool fewer_rounds() {
  const char* const wanted = std::getenv("POPCUT_ROUNDS");
  return wanted == nullptr ? kWithSanitizer : std::string_view(wanted) == "few";
}

/// `all`, or one in `part` of them.
[[nodiscard]] inline int rounds(int all, int part = 5) { return fewer_rounds() ? all / part : all; }

/// The distance between the places that are tried: `step`, or `times` as much.
[[nodiscard]] inline int step_of(int step, int times = 5) {
  return fewer_rounds() ? step * times : step;
}

}  // namespace popcut::testing

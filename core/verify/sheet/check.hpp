// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace popcut {

/// A failure: where (JSON pointer into the FOLD file) and what.
struct VerifyFailure {
  std::string place;
  std::string detail;
};

/// Where a face or an edge stands in a FOLD file.
[[nodiscard]] inline std::string face_place(std::uint32_t f) {
  return fmt::format("/faces_vertices/{}", f);
}
[[nodiscard]] inline std::string edge_place(std::uint32_t e) {
  return fmt::format("/edges_vertices/{}", e);
}

/// After so many failures of one kind the search for more ends.
inline constexpr std::size_t kMostReported = 1000;

/// One check of a pattern. It lists the first `kListed` failures and counts the rest.
struct VerifyCheck {
  static constexpr std::size_t kListed = 20;

  std::string name;    ///< stable, so that scripts can look for it
  std::string detail;  ///< the figures, in a sentence
  bool ran{true};      ///< false: the check could not run, and `detail` says why
  std::size_t failed{};
  std::vector<VerifyFailure> failures;

  [[nodiscard]] bool ok() const { return failed == 0; }
  void fail(std::string place, std::string what) {
    ++failed;
    if (failures.size() < kListed) failures.push_back({std::move(place), std::move(what)});
  }
  /// Marks the check as not made, unless it has already found a failure.
  void not_judged(std::string why) {
    if (failed > 0) return;
    ran = false;
    detail = "not checked: " + std::move(why);
  }
};

}  // namespace popcut
